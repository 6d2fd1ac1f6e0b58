// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kMicrometresInMm = 1000;
constexpr double kArcminute = kRadPerDeg / 60, kArcsecond = kRadPerDeg / 3600;

/// Largest over the points of the face of what turning every joint's output by an angle could give, mm per
/// rad: Σ|n·J_i|.
double LargestLeverSum(const LostMotionReport& lost) {
  double largest = 0;
  for (const std::optional<double>& sum : lost.course.lever_sums)
    if (sum) largest = std::max(largest, *sum);
  return largest;
}

std::string Between(double low, double high, double levers) {
  return fmt::format("{:.0f} to {:.0f} µm", kMicrometresInMm * low * levers,
                     kMicrometresInMm * high * levers);
}

void AddForce(const DeflectionReport* deflection, std::vector<BudgetRow>& rows) {
  BudgetRow expected{"static_compliance", "static compliance", {}, {}};
  BudgetRow uncertain{"force_uncertainty", "force uncertainty", {}, {}};
  if (deflection == nullptr) {
    expected.basis = uncertain.basis =
        "the job does not say what is cut (process.cutting); published: a robot yields some 1 µm per newton, "
        "a "
        "machine tool a fiftieth of it (Machines 2025, 13, 822)";
  } else {
    double largest = 0, within = 0;
    for (const DeflectedPoint& point : deflection->points)
      if (point.face) {
        largest = std::max(largest, std::abs(point.deflection.normal));
        within = std::max(within, point.largest_normal);
      }
    expected.largest = largest;
    expected.basis = "largest displacement under the mean cutting force as computed";
    if (!deflection->source.empty()) expected.basis += "; force coefficients: " + deflection->source;
    uncertain.largest = std::max(0.0, within - largest);
    uncertain.basis =
        fmt::format("how much more a force gives that is up to {:.3g} % longer and {:.3g} deg off",
                    100 * deflection->bounds.length, RadToDeg(deflection->bounds.angle));
  }
  rows.push_back(std::move(expected));
  rows.push_back(std::move(uncertain));
}

BudgetRow LostMotionRow(const LostMotionReport& lost, double levers) {
  BudgetRow row{"lost_motion", "lost motion", {}, {}};
  if (lost.Known() && lost.model.known[0]) {
    row.largest = lost.tally.worst;
    row.basis = fmt::format(
        "largest displacement from the middle of the gaps; one reversal steps by up to {:.3g} µm; {}",
        kMicrometresInMm * lost.tally.largest, lost.source);
  } else {
    row.basis = fmt::format(
        "arm.lost_motion_arcmin; published: 0.3 to 0.6 arcmin for cycloidal gears "
        "(nabtesco.de/en/faq/backlash), in every joint {} here",
        Between(0.15 * kArcminute, 0.3 * kArcminute, levers));
  }
  return row;
}

BudgetRow TakenOutRow(const GeometryFigures& geometry) {
  const std::string left =
      geometry.left
          ? "what the measurements leave at the point that they tell least of, with 95 % probability "
            "(arm.deviations.patterns)"
      : geometry.uncertainty
          ? "what the measurements leave, with 95 % probability"
          : "by how much the measurements are off is not in it (arm.deviations.uncertainty_mm)";
  return {"geometry", "geometry",
          std::max(geometry.largest, geometry.left.value_or(geometry.uncertainty.value_or(0))),
          fmt::format("taken out of the programs for arm {} as measured on {} (compensation.deviations); {}",
                      geometry.serial, geometry.date, left)};
}

/// Of the gears' periodic error what a table of this arm says, and what nobody knows the phase of.
BudgetRow GearRow(const LostMotionReport& lost, const GeometryFigures* geometry, double levers) {
  BudgetRow row{"gear_error", "gear error", {}, {}};
  std::optional<double> unknown;
  if (lost.model.error) {
    unknown = 0;
    for (const std::optional<double>& one : lost.course.periodic)
      unknown = std::max(*unknown, one.value_or(0));
  }
  const bool table = geometry != nullptr && geometry->gears;
  if (unknown || table) row.largest = unknown.value_or(0) + (table ? *geometry->gears : 0);
  if (table && geometry->taken_out)
    row.basis = fmt::format(
        "{:.3g} µm between the points of the path, at which the programs take out the tables of arm {}; ",
        kMicrometresInMm * *geometry->gears, geometry->serial);
  else if (table)
    row.basis = fmt::format(
        "{:.3g} µm by the tables of arm {}, of which its controller knows nothing (arm.deviations.gears); ",
        kMicrometresInMm * *geometry->gears, geometry->serial);
  if (unknown)
    row.basis += table ? "what they leave, of unknown phase: at most, all gears adding up (arm.gear_error)"
                       : "periodic, of unknown phase: at most, all gears adding up (arm.gear_error)";
  else if (table)
    row.basis += "what they leave nothing states (arm.gear_error)";
  else
    row.basis = fmt::format(
        "transmission error of the gears; published: some 10 to 60 arcsec, in every joint at once {} here; "
        "it "
        "repeats, and much of it is the same for any pose",
        Between(10 * kArcsecond, 60 * kArcsecond, levers));
  return row;
}

}  // namespace

double Budget::Sum() const {
  double sum = 0;
  for (const BudgetRow& row : rows) sum += row.largest.value_or(0);
  return sum;
}

std::vector<const BudgetRow*> Budget::Largest() const {
  std::vector<const BudgetRow*> stated;
  for (const BudgetRow& row : rows)
    if (row.largest) stated.push_back(&row);
  std::ranges::stable_sort(stated, std::greater(), [](const BudgetRow* row) { return *row->largest; });
  return stated;
}

std::vector<std::string> Budget::LeftOut() const {
  std::vector<std::string> names;
  for (const BudgetRow& row : rows)
    if (!row.largest) names.push_back(row.name);
  return names;
}

Budget MakeBudget(const DeflectionReport* deflection, const LostMotionReport& lost,
                  const RegistrationFigures* registration, const GeometryFigures* geometry) {
  Budget budget;
  const double levers = LargestLeverSum(lost);
  AddForce(deflection, budget.rows);
  budget.rows.push_back(LostMotionRow(lost, levers));
  const auto missing = [&](const char* key, const char* name, std::string basis) {
    budget.rows.push_back({key, name, std::nullopt, std::move(basis)});
  };
  budget.rows.push_back(GearRow(lost, geometry, levers));
  if (geometry != nullptr && geometry->taken_out)
    budget.rows.push_back(TakenOutRow(*geometry));
  else if (geometry != nullptr)
    budget.rows.push_back(
        {"geometry", "geometry", geometry->largest,
         fmt::format("arm {} as measured on {}, its controller computing with the nominal one and the part's "
                     "frame measured with it all over the face; with a frame from elsewhere {:.0f} µm",
                     geometry->serial, geometry->date, kMicrometresInMm * geometry->absolute)});
  else
    missing("geometry", "geometry",
            "the arm's true lengths and axes against the nominal ones; published: 0.65 mm on an IRB 1600 "
            "(Slamani, Nubiola, Bonev 2012)");
  if (registration != nullptr)
    budget.rows.push_back(
        {"registration", "registration", registration->off_95,
         "with 95 % probability no point of the face is farther off (docs/registration.md)"});
  else
    missing(
        "registration", "registration",
        "where the part stands; three surfaces probed by the robot itself some 0.5 mm, forty points 0.1 mm "
        "(docs/budget.md)");
  missing("thermal", "thermal", "warm arms grow; published: some 0.1 mm in warm-up");
  missing("dynamics", "dynamics",
          "vibration and chatter; robots' own low modes show in slow cuts (Cordes, Hintze, Altintas 2019)");
  return budget;
}

namespace {

std::vector<std::string> LargestThree(const Budget& budget) {
  const std::vector<const BudgetRow*> stated = budget.Largest();
  std::vector<std::string> parts;
  for (size_t i = 0; i < std::min<size_t>(3, stated.size()); ++i)
    parts.push_back(fmt::format("{} {:.3g} µm", stated[i]->name, kMicrometresInMm * *stated[i]->largest));
  return parts;
}

}  // namespace

std::string BudgetText(const Budget& budget) {
  const std::vector<std::string> parts = LargestThree(budget), left_out = budget.LeftOut();
  if (parts.empty())
    return fmt::format("nothing is stated of the face's error: {}", fmt::join(left_out, ", "));
  return fmt::format(
      "of the face's error along its normal: {}; {:.3g} µm together, without {}, which nothing states",
      fmt::join(parts, ", "), kMicrometresInMm * budget.Sum(), fmt::join(left_out, ", "));
}

std::string BudgetBrief(const Budget& budget) {
  const std::vector<std::string> parts = LargestThree(budget), left_out = budget.LeftOut();
  if (parts.empty()) return "of its error nothing is stated (docs/budget.md)";
  return fmt::format("off by up to {:.3g} µm along its normal: {}; not stated: {}",
                     kMicrometresInMm * budget.Sum(), fmt::join(parts, ", "), fmt::join(left_out, ", "));
}

}  // namespace millpose
