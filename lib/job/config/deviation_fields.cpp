// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `arm.deviations`: how one arm differs from its sheet.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

const Unit kMrad{"mrad", 1, 1000};

/// Where `key` is given: seven rows, base to flange.
void CheckRows(const Value& value, const Context& context, const char* key,
               const std::vector<Eigen::Vector3d>& rows) {
  if (const auto* given = value.FindKey(key); given && rows.size() != 7)
    context.Child(key).Add(given->mark,
                           fmt::format("given {} rows; allowed: seven, base to flange", rows.size()));
}

/// 2026-11-26.
bool IsDate(const std::string& text) {
  constexpr std::string_view kForm = "dddd-dd-dd";
  if (text.size() != kForm.size()) return false;
  for (size_t i = 0; i < text.size(); ++i)
    if (kForm[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != kForm[i]) return false;
  return true;
}

Codec<JointHarmonic> HarmonicFields() {
  using S = JointHarmonic;
  return Section<S>({
      Key<S>("joint", MILLPOSE_AT(joint), Integer(1, 6), "Whose gear it is, 1 to 6.").Required(),
      Key<S>(
          "harmonic", MILLPOSE_AT(harmonic), Real(kOne, Between(0.1, 1000)),
          "Waves in one turn of the joint: 1 of a gear out of centre; of most gears once or twice the ratio "
          "as well.")
          .Required(),
      Key<S>("amplitude_arcsec", MILLPOSE_AT(amplitude), Real(kArcsec, Positive(3600)),
             "From the mean to the largest.")
          .Required(),
      Key<S>(
          "phase_deg", MILLPOSE_AT(phase), Real(kDeg, Between(-360, 360)),
          "The joint is ahead of the controller's angle by amplitude × sin(harmonic × angle + phase), in the "
          "arm's own sense and zero.")
          .Required(),
  });
}

Codec<JointCoupling> FollowerFields() {
  using S = JointCoupling;
  return Section<S>(
      {
          Key<S>("joint", MILLPOSE_AT(joint), Integer(1, 6), "Which turns beside its own angle, 1 to 6.")
              .Required(),
          Key<S>("follows", MILLPOSE_AT(follows), Integer(1, 6), "Another joint.").Required(),
          Key<S>("factor", MILLPOSE_AT(factor), Real(kOne, Between(-0.1, 0.1)),
                 "By how much of that joint's angle.")
              .Required(),
      },
      [](const Value& value, const Context& context, S& pair) {
        if (pair.joint == pair.follows)
          context.Child("follows").Add(
              value.Find("follows")->mark,
              fmt::format("given {}, the joint itself; allowed: another", pair.follows));
        if (pair.factor == 0)
          context.Child("factor").Add(value.Find("factor")->mark, "given 0, which has no effect");
      });
}

Codec<DeviationPattern> PatternFields() {
  using S = DeviationPattern;
  return Section<S>(
      {
          Key<S>("shifts_mm", MILLPOSE_AT(shifts), ListOf(Numbers3(kMm, Between(-50, 50))),
                 "Seven rows, as those of the deviations.")
              .Required(),
          Key<S>("turns_mrad", MILLPOSE_AT(turns), ListOf(Numbers3(kMrad, Between(-100, 100))), "Likewise.")
              .Required(),
          Key<S>("factors", MILLPOSE_AT(factors), ListOf(Real(kOne, Between(-0.1, 0.1))),
                 "Likewise of `couplings`, in their order.")
              .WhenSet([](const S& s) { return !s.factors.empty(); })
              .DefaultText("0: these are known"),
      },
      [](const Value& value, const Context& context, S& s) {
        CheckRows(value, context, "shifts_mm", s.shifts);
        CheckRows(value, context, "turns_mrad", s.turns);
      });
}

/// Seven rows each, which may be left out where the joints alone differ.
void CheckFrames(const Value& value, const Context& context, DeviationSettings& s) {
  CheckRows(value, context, "shifts_mm", s.shifts);
  CheckRows(value, context, "turns_mrad", s.turns);
  for (std::vector<Eigen::Vector3d>* rows : {&s.shifts, &s.turns})
    if (rows->empty()) rows->assign(7, Eigen::Vector3d::Zero());
}

/// As many as there are couplings, or none.
void CheckFactors(const Value& value, const Context& context, const DeviationSettings& s) {
  for (size_t i = 0; i < s.patterns.size(); ++i) {
    const size_t given = s.patterns[i].factors.size();
    if (given == 0 || given == s.couplings.size()) continue;
    const Value& pattern = value.Find("patterns")->items[i];
    context.Child("patterns")
        .Child(i)
        .Child("factors")
        .Add(pattern.FindKey("factors")->mark,
             fmt::format("given {} numbers; allowed: {}, as arm.deviations.couplings has entries", given,
                         s.couplings.size()));
  }
}

/// No two entries of one kind, and nothing that is no gear's.
void CheckLaw(const Value& value, const Context& context, const DeviationSettings& s) {
  const auto twice = [&](const char* key, size_t i, const std::string& what) {
    context.Child(key).Child(i).Add(value.Find(key)->items[i].mark, fmt::format("given {} twice", what));
  };
  for (size_t i = 0; i < s.gears.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (s.gears[i].joint == s.gears[j].joint && s.gears[i].harmonic == s.gears[j].harmonic)
        twice("gears", i, fmt::format("harmonic {} of joint {}", s.gears[i].harmonic, s.gears[i].joint));
  for (size_t i = 0; i < s.couplings.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (s.couplings[i].joint == s.couplings[j].joint && s.couplings[i].follows == s.couplings[j].follows)
        twice("couplings", i,
              fmt::format("joint {} with joint {}", s.couplings[i].joint, s.couplings[i].follows));
  const double slope = JointLaw{s.gears, s.couplings}.SteepestSlope();
  if (slope < JointLaw::kSteepest) return;
  const char* key = s.gears.empty() ? "couplings" : "gears";
  context.Child(key).Add(
      value.Find(key)->mark,
      fmt::format("a joint that turns by up to {:.3g} of the controller's turn more or less (amplitude × "
                  "harmonic, with its couplings, summed); allowed: less than {:.6g}",
                  slope, JointLaw::kSteepest));
}

}  // namespace

void CheckDeviations(const Value& value, const Context& context, const ArmSettings& arm) {
  const auto *serial = value.FindKey("serial"), *deviations = value.FindKey("deviations");
  if (deviations && !serial)
    context.Child("serial").Add(deviations->mark, "missing; required with deviations: whose they are");
  if (serial && !deviations)
    context.Child("serial").Add(serial->mark, "has no effect here: deviations is missing");
  if (deviations && arm.absolute_accuracy)
    context.Child("deviations")
        .Add(deviations->mark,
             "given together with absolute_accuracy: true, a controller that knows them itself; allowed: one "
             "of the two");
  const bool table = arm.deviations && !arm.deviations->gears.empty();
  if (const auto* given = value.FindKey("gear_couplings"); given && table)
    context.Child("gear_couplings")
        .Add(given->mark,
             "given together with deviations.gears, whose waves count along the joints' own turns; allowed: "
             "one "
             "of the two");
}

Codec<DeviationSettings> DeviationFields() {
  using S = DeviationSettings;
  return Section<S>(
      {
          Key<S>("shifts_mm", MILLPOSE_AT(shifts), ListOf(Numbers3(kMm, Between(-50, 50))),
                 "Seven rows, of the frames 0 (base) and 1 to 6 (after joint 1 to 6; 6 is the flange): where "
                 "each truly stands, in the axes of its nominal self.")
              .RequiredUnless("gears, couplings"),
          Key<S>("turns_mrad", MILLPOSE_AT(turns), ListOf(Numbers3(kMrad, Between(-100, 100))),
                 "Likewise how it is turned: rotation vectors.")
              .RequiredUnless("gears, couplings"),
          Key<S>("gears", MILLPOSE_AT(gears), ListOf(HarmonicFields()),
                 "Tables of the gears' transmission error, one entry for each wave of a joint "
                 "(docs/gear-table.md). What they leave, `arm.gear_error` says.")
              .WhenSet([](const S& s) { return !s.gears.empty(); })
              .DefaultText("none"),
          Key<S>("couplings", MILLPOSE_AT(couplings), ListOf(FollowerFields()),
                 "Joints that turn a little with others: {joint: 3, follows: 2, factor: 0.00045}.")
              .WhenSet([](const S& s) { return !s.couplings.empty(); })
              .DefaultText("none"),
          Key<S>("uncertainty_mm", MILLPOSE_AT(uncertainty), Maybe(Real(kMm, UpTo(10))),
                 "How far a point of the flange may be off along any direction once they are taken out, 95 "
                 "%; the "
                 "budget tells it then.")
              .WhenSet([](const S& s) { return s.uncertainty.has_value(); })
              .DefaultText("not known"),
          Key<S>("patterns", MILLPOSE_AT(patterns), ListOf(PatternFields()),
                 "In which ways the frames may still be off together, independent of each other, each by its "
                 "standard deviation: what is left at each point of a face follows from them in place of "
                 "uncertainty_mm. `millpose identify --geometry` writes them.")
              .WhenSet([](const S& s) { return !s.patterns.empty(); })
              .DefaultText("none"),
          Key<S>("source", MILLPOSE_AT(source), Lines(), "How they were found, and how sure they are.")
              .Required(),
          Key<S>("date", MILLPOSE_AT(date), Text(), "When they were measured: year-month-day.").Required(),
      },
      [](const Value& value, const Context& context, S& s) {
        CheckFrames(value, context, s);
        CheckFactors(value, context, s);
        CheckLaw(value, context, s);
        if (const auto* given = value.FindKey("date"); given && !IsDate(s.date))
          context.Child("date").Add(given->mark,
                                    fmt::format("given {}; allowed: a date such as 2026-11-26", s.date));
      });
}

}  // namespace millpose::config
