// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/compensation.hpp"

#include "base/units.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr double kMicrometres = 1000;

void AppendAlong(const Compensation::Along& d, std::string& row) {
  fmt::format_to(std::back_inserter(row), ",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}",
                 kMicrometres * d.low, kMicrometres * d.expected, kMicrometres * d.high,
                 kMicrometres * d.taken, kMicrometres * (d.expected - d.taken),
                 kMicrometres * d.LargestBefore(), kMicrometres * d.LargestAfter());
}

void AppendVector(const Eigen::Vector3d& v, std::string& row) {
  fmt::format_to(std::back_inserter(row), ",{:.17g},{:.17g},{:.17g}", v.x(), v.y(), v.z());
}

}  // namespace

bool CouldHurt(const Compensation::Along& d) {
  // |x − taken| > |x| for some x of [low, high]: x on taken's side of half of it is safe.
  constexpr double kRounding = 1e-12;
  if (d.taken == 0) return false;
  return d.taken > 0 ? d.low < 0.5 * d.taken * (1 - kRounding) : d.high > 0.5 * d.taken * (1 - kRounding);
}

std::optional<CompensationFigures> FiguresOfCompensation(const PlanResult& plan) {
  CompensationFigures figures;
  bool any = false;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (!point.compensation) continue;
      any = true;
      const Compensation& c = *point.compensation;
      figures.bounded += c.bounded;
      figures.largest_shift = std::max(figures.largest_shift, c.shift.norm());
      figures.largest_map = std::max(figures.largest_map, std::abs(c.map));
      figures.largest_weight = std::max(figures.largest_weight, c.weight.norm());
      figures.largest_arm_shift = std::max(figures.largest_arm_shift, c.arm_shift.norm());
      figures.largest_arm_turn = std::max(figures.largest_arm_turn, c.arm_turn.norm());
      if (c.arm_left) figures.arm_left = std::max(figures.arm_left.value_or(0), *c.arm_left);
      if (!c.gear_shift.isZero(0.0))
        figures.largest_gear = std::max(figures.largest_gear.value_or(0), c.gear_shift.norm());
      figures.shifts |= !c.shift.isZero(0.0) || !c.force.isZero(0.0);
      if (c.force.isZero(0.0)) continue;
      const Compensation::Along& d = c.normal;
      ++figures.points;
      figures.left_alone += c.normal.taken == 0 && c.across.taken == 0;
      figures.expected_before = std::max(figures.expected_before, std::abs(d.expected));
      figures.expected_after = std::max(figures.expected_after, std::abs(d.expected - d.taken));
      figures.worst_before = std::max(figures.worst_before, d.LargestBefore());
      figures.worst_after = std::max(figures.worst_after, d.LargestAfter());
      figures.could_hurt |= CouldHurt(d);
    }
  if (!any) return std::nullopt;
  return figures;
}

std::string CompensationCsv(const PlanResult& plan) {
  std::string csv = "point,pass,force_x_N,force_y_N,force_z_N";
  for (const char* along : {"normal", "across"})
    for (const char* what : {"low", "expected", "high", "taken", "after", "worst_before", "worst_after"})
      fmt::format_to(std::back_inserter(csv), ",{}_{}_um", along, what);
  csv +=
      ",shift_x_um,shift_y_um,shift_z_um,weight_x_um,weight_y_um,weight_z_um,cut_to_max,map_um"
      ",arm_x_um,arm_y_um,arm_z_um,arm_turn_x_mrad,arm_turn_y_mrad,arm_turn_z_mrad";
  const std::optional<CompensationFigures> figures = FiguresOfCompensation(plan);
  const bool gears = figures && figures->largest_gear;
  const bool left = figures && figures->arm_left;
  csv += gears ? ",gear_x_um,gear_y_um,gear_z_um" : "";
  csv += left ? ",arm_left_um_95\n" : "\n";
  size_t number = 0;
  for (const PassResult& pass : plan.passes) {
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const PlannedPoint& point = pass.points[i];
      const size_t here = number++;
      if (!point.compensation) continue;
      const Eigen::Matrix3d R_PW = PartAt(plan, ExternalAt(pass, i)).linear().transpose();
      const Compensation& c = *point.compensation;
      std::string row = fmt::format("{},{}", here, pass.pass);
      AppendVector(R_PW * c.force, row);
      AppendAlong(c.normal, row);
      AppendAlong(c.across, row);
      AppendVector(kMicrometres * (R_PW * c.shift), row);
      AppendVector(-kMicrometres * (R_PW * c.weight), row);
      fmt::format_to(std::back_inserter(row), ",{},{:.17g}", c.bounded ? 1 : 0, kMicrometres * c.map);
      AppendVector(kMicrometres * (R_PW * c.arm_shift), row);
      AppendVector(1e3 * (R_PW * c.arm_turn), row);
      if (gears) AppendVector(kMicrometres * (R_PW * c.gear_shift), row);
      if (left) row += c.arm_left ? fmt::format(",{:.17g}", kMicrometres * *c.arm_left) : std::string(",");
      csv += row + '\n';
    }
  }
  return csv;
}

std::string CompensationText(const CompensationFigures& f) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (f.largest_arm_shift > 0)
    fmt::format_to(out,
                   "the arm's deviations are taken out: tip commanded up to {:.3f} mm elsewhere, tool "
                   "turned by up to {:.3f} deg\n",
                   f.largest_arm_shift, RadToDeg(f.largest_arm_turn));
  if (f.largest_gear)
    fmt::format_to(out, "  of it, tables and couplings of its joints move the tip by up to {:.3f} mm\n",
                   *f.largest_gear);
  if (f.shifts || f.largest_arm_shift == 0)
    fmt::format_to(out, "compensation of {} cut points, tip shifted by at most {:.1f} µm\n", f.points,
                   kMicrometres * f.largest_shift);
  if (f.points > 0)
    fmt::format_to(
        out,
        "  worst error along the normal: {:.3g} µm expected, {:.3g} µm possible; compensated {:.3g} "
        "and {:.3g} µm\n",
        kMicrometres * f.expected_before, kMicrometres * f.worst_before, kMicrometres * f.expected_after,
        kMicrometres * f.worst_after);
  if (f.remains)
    fmt::format_to(out, "  where something is taken out, {:.0f} % of the error remains in the median\n",
                   100 * *f.remains);
  if (f.left_alone > 0)
    fmt::format_to(out, "  {} points are left alone: nothing that can be taken out there is sure to help\n",
                   f.left_alone);
  if (f.largest_weight > 0)
    fmt::format_to(out, "  of the shift, at most {:.1f} µm are the arm's own weight\n",
                   kMicrometres * f.largest_weight);
  if (f.largest_map > 0)
    fmt::format_to(out, "  of the shift, at most {:.1f} µm follow the map of a measured part\n",
                   kMicrometres * f.largest_map);
  for (const CarriedBy& program : f.programs)
    fmt::format_to(out, "  {}: its program carries it to within {:.2g} µm\n", program.controller,
                   kMicrometres * program.largest);
  return text;
}

}  // namespace millpose
