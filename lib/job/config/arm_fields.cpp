// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `arm:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

Codec<UrdfSettings> UrdfFields() {
  using S = UrdfSettings;
  return Section<S>(
      {
          Key<S>("file", MILLPOSE_AT(file), Text(), "URDF, relative to the cell file.").Required(),
          Key<S>("base_link", MILLPOSE_AT(base_link), Text(), "Link whose frame is the robot base.")
              .Required(),
          Key<S>("flange_link", MILLPOSE_AT(flange_link), Text(),
                 "Link whose frame is the flange; six joints lead to it from the base.")
              .Required(),
          Key<S>("packages", MILLPOSE_AT(packages), MapOf<std::string>({}, Text()),
                 "Folders that `package://NAME/` stands for, relative to the cell file."),
          Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Positive(10)),
                 "Largest deviation of the closed form from the file's joints."),
      },
      [](const Value& value, const Context&, S& urdf) { urdf.line = value.mark.line; });
}

Codec<DhRow> DhRowFields() {
  using S = DhRow;
  return Section<S>({
      Key<S>("a_mm", MILLPOSE_AT(a), Real(kMm, Between(-10000, 10000)), "Length of the row's link."),
      Key<S>("alpha_deg", MILLPOSE_AT(alpha), Real(kDeg, Between(-360, 360)), "Its twist."),
      Key<S>("d_mm", MILLPOSE_AT(d), Real(kMm, Between(-10000, 10000)), "Along the axis."),
      Key<S>("theta_deg", MILLPOSE_AT(theta), Real(kDeg, Between(-360, 360)),
             "About it where the arm's own angle is 0."),
      Key<S>("sign", MILLPOSE_AT(sign), Integer(-1, 1),
             "1 or -1: theta = sign × the arm's own angle + theta_deg."),
  });
}

Codec<DhSettings> DhFields() {
  using S = DhSettings;
  const auto check = [](const Value& value, const Context& context, S& dh) {
    dh.line = value.mark.line;
    if (dh.rows.size() != 6)
      context.Child("rows").Add(
          value.mark, fmt::format("given {} rows; allowed: six, one for each axis", dh.rows.size()));
    for (size_t i = 0; i < dh.rows.size(); ++i)
      if (dh.rows[i].sign == 0)
        context.Child(fmt::format("rows[{}].sign", i)).Add(value.mark, "given 0; allowed: 1, -1");
  };
  return Section<S>(
      {Key<S>("convention", MILLPOSE_AT(convention), ChoiceOf(kDhConventionWords),
              "standard: a and alpha behind the row's axis (Denavit and Hartenberg); modified: before it "
              "(Craig).")
           .Required(),
       Key<S>("rows", MILLPOSE_AT(rows), ListOf(DhRowFields()), "Six rows from the base to the flange.")
           .Required(),
       Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Positive(10)),
              "Largest deviation of the closed form from the table.")},
      check);
}

Codec<CoupledLimit> CoupledFields() {
  using S = CoupledLimit;
  return Section<S>({Key<S>("a", MILLPOSE_AT(factors), Numbers6(kOne, Between(-100, 100)),
                            "Factors of the six axes; 0 for those that do not matter.")
                         .Required(),
                     Key<S>("at_most", MILLPOSE_AT(at_most), Real(kDeg, Between(-3600, 3600)),
                            "Largest sum of factors times angles, deg.")
                         .Required()});
}

/// d5 belongs to parallel axes, and to nothing else.
void CheckLengths(const Value& lengths, const Context& context, const ArmSettings& arm) {
  const auto* given = lengths.FindKey("d5");
  if (arm.family == ArmFamily::kParallelAxes && !given)
    context.Child("d5").Add(lengths.mark, "missing; required where arm.family is parallel_axes: number");
  if (arm.family != ArmFamily::kParallelAxes && given)
    context.Child("d5").Add(given->mark,
                            "has no effect with a spherical wrist; allowed where arm.family is "
                            "parallel_axes");
}

/// With a URDF, what it says is not said again; what it does not say must be.
void CheckArm(const Value& value, const Context& context, ArmSettings& arm) {
  CheckGears(value, context, arm);
  CheckDeviations(value, context, arm);
  if (const auto* coupled = value.FindKey("coupled_limits_deg")) arm.coupled_line = coupled->mark.line;
  const bool table = !arm.dh.rows.empty();
  if (arm.urdf.file.empty() && !table)
    return CheckLengths(*value.Find("lengths_mm"), context.Child("lengths_mm"), arm);
  if (!arm.urdf.file.empty() && table)
    context.Child("dh").Add(value.FindKey("dh")->mark,
                            "given together with arm.urdf; allowed: one of the two");
  for (const char* key : {"family", "lengths_mm", "axis_signs", "zero_offsets_deg"})
    if (const auto* given = value.FindKey(key))
      context.Child(key).Add(given->mark, fmt::format("is derived from the {}; allowed: one of the two",
                                                      table ? "D-H table" : "URDF"));
}

}  // namespace

Codec<ArmSettings> ArmFields() {
  using S = ArmSettings;
  const auto explicit_arm = [](const S& s) { return s.urdf.file.empty() && s.dh.rows.empty(); };
  const auto length = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kMm, Between(-10000, 10000)), doc).Required();
  };
  return Section<S>(
      WithGears({
          Key<S>("name", MILLPOSE_AT(name), Text(), "Maker and model.").Required(),
          Key<S>("serial", MILLPOSE_AT(serial), Text(), "Serial number of the arm that `deviations` are of.")
              .WhenSet([](const S& s) { return s.deviations.has_value(); }),
          Key<S>("deviations", MILLPOSE_AT(deviations), Maybe(DeviationFields()),
                 "How this arm's geometry differs from its sheet; a line of the budget "
                 "(docs/arm-deviations.md). Needs `serial`.")
              .WhenSet([](const S& s) { return s.deviations.has_value(); })
              .DefaultText("not known"),
          Key<S>(
              "urdf", MILLPOSE_AT(urdf), UrdfFields(),
              "A URDF from which lengths, signs, offsets, limits, speeds and bodies of the links are taken.")
              .WhenSet([](const S& s) { return !s.urdf.file.empty(); }),
          Key<S>("dh", MILLPOSE_AT(dh), DhFields(),
                 "A table after Denavit and Hartenberg, from which lengths, signs and offsets are taken.")
              .WhenSet([](const S& s) { return !s.dh.rows.empty(); }),
          Key<S>("family", MILLPOSE_AT(family), ChoiceOf(kArmFamilyWords),
                 "Axes 4, 5, 6 meet in one point, or axes 2, 3, 4 are parallel (UR, Techman, AUBO, JAKA).")
              .WhenSet([explicit_arm](const S& s) {
                return explicit_arm(s) && s.family != ArmFamily::kSphericalWrist;
              })
              .DefaultText("spherical_wrist"),
          Key<S>(
              "lengths_mm", kSelf,
              Section<S>({
                  length("d1", MILLPOSE_AT(d1), "Height of axis 2 above the base."),
                  length("a1", MILLPOSE_AT(a1), "Axis 1 to axis 2, horizontally."),
                  Key<S>("dy", MILLPOSE_AT(dy), Real(kMm, Between(-10000, 10000)),
                         "Axis 1 to the wrist centre, sideways: along axis 2.")
                      .WhenSet([](const S& s) { return s.dy != 0; })
                      .DefaultText("0"),
                  length("a2", MILLPOSE_AT(a2), "Axis 2 to axis 3."),
                  length("d4", MILLPOSE_AT(d4),
                         "Axis 3 to the wrist centre (parallel_axes: to axis 4), along the forearm."),
                  length("dz", MILLPOSE_AT(dz), "The same, across the forearm."),
                  Key<S>("d5", MILLPOSE_AT(d5), Real(kMm, Between(-10000, 10000)),
                         "Only of parallel_axes and needed there: axis 4 to the wrist centre, along axis 5.")
                      .WhenSet([](const S& s) { return s.family == ArmFamily::kParallelAxes; }),
                  length("d6", MILLPOSE_AT(d6), "Wrist centre to the flange."),
              }),
              "Lengths of the arm as in the formula of docs/kinematics.md.")
              .WhenSet(explicit_arm)
              .RequiredUnless("urdf, dh"),
          Key<S>("axis_signs", MILLPOSE_AT(sign), Signs(), "Sense of each axis; KUKA: [-1, 1, 1, -1, 1, -1].")
              .WhenSet(explicit_arm)
              .RequiredUnless("urdf, dh"),
          Key<S>("zero_offsets_deg", MILLPOSE_AT(offset), Numbers6(kDeg, Between(-360, 360)),
                 "Inner angle where the arm's own angle is 0.")
              .WhenSet(explicit_arm)
              .DefaultText("[0, 0, 0, 0, 0, 0]"),
          KeyBy<S, std::array<Six, 2>>(
              "limits_deg",
              [](const S& s) {
                return std::array<Six, 2>{s.lower, s.upper};
              },
              [](S& s, const std::array<Six, 2>& limits) {
                s.lower = limits[0];
                s.upper = limits[1];
              },
              Limits(), "Limits of the axes; with a URDF, in place of its own.")
              .WhenSet([](const S& s) { return s.lower != s.upper; })
              .RequiredUnless("urdf"),
          Key<S>("speeds_deg_s", MILLPOSE_AT(speed), Numbers6(kDegPerS, Positive(3600)),
                 "Largest speeds of the axes; with a URDF, in place of its own.")
              .WhenSet([](const S& s) { return !s.speed.isZero(0.0); })
              .RequiredUnless("urdf"),
          Key<S>("coupled_limits_deg", MILLPOSE_AT(coupled_limits), ListOf(CoupledFields()),
                 "Limits that couple axes, in the arm's own angles: the sum of a[i] × A[i] is at_most that. "
                 "A3 - A2 "
                 "≤ 67°: {a: [0, -1, 1, 0, 0, 0], at_most: 67}.")
              .WhenSet([](const S& s) { return !s.coupled_limits.empty(); })
              .DefaultText("none"),
          Key<S>("limits_source", MILLPOSE_AT(limits_source), Lines(), "Where limits and speeds come from."),
          Key<S>("accelerations_deg_s2", MILLPOSE_AT(acceleration), Numbers6(kDegPerS2, Positive(1e5)),
                 "Largest accelerations of the axes.")
              .Required(),
          Key<S>("accelerations_assumed", MILLPOSE_AT(acceleration_assumed), Flag(),
                 "Whether the accelerations are an assumption without a source."),
          Key<S>("joint_stiffness_Nm_per_rad", MILLPOSE_AT(stiffness),
                 Numbers6(kNmPerRad, Between(100, 1e10)), "Stiffness of the joints.")
              .Required(),
          Key<S>("stiffness_uncertainty_percent", MILLPOSE_AT(stiffness_uncertainty),
                 Numbers6(kPercent, Between(0, 90)),
                 "Half the width of each stiffness's 95 % interval (millpose identify writes it); for "
                 "compensation.")
              .WhenSet([](const S& s) { return !s.stiffness_uncertainty.isZero(0.0); })
              .DefaultText("not known"),
          Key<S>("absolute_accuracy", MILLPOSE_AT(absolute_accuracy), Flag(),
                 "Whether the controller itself takes out what the arm's weight bends; compensation leaves "
                 "weight alone then.")
              .WhenSet([](const S& s) { return s.absolute_accuracy; })
              .DefaultText("false"),
          Key<S>("joint_stiffness_source", MILLPOSE_AT(stiffness_source), Lines(),
                 "Where the stiffness comes from."),
      }),
      CheckArm);
}

}  // namespace millpose::config
