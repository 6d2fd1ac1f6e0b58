// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/fixed_json.hpp"

#include "base/units.hpp"
#include "report/fixed_figures.hpp"
#include "report/lost_motion_json.hpp"

namespace millpose {
namespace {

using FixedTree = nlohmann::ordered_json;

/// Worst and median of one comparison, mm or the objective's unit; null where there is none.
FixedTree FixedOf(const ComparedFigures& plan, const ComparedFigures& fixed) {
  if (fixed.points == 0) return nullptr;
  const auto pair = [](double of_plan, double of_fixed) {
    return FixedTree{{"plan", of_plan},
                     {"fixed", of_fixed},
                     {"ratio", of_fixed > 0 ? FixedTree(of_plan / of_fixed) : FixedTree(nullptr)}};
  };
  FixedTree json = FixedTree::object();
  for (const FixedFigure& figure : FixedFigures(plan, fixed))
    json[figure.key] = {{"worst", pair(figure.plan.worst, figure.fixed.worst)},
                        {"median", pair(figure.plan.median, figure.fixed.median)}};
  return json;
}

}  // namespace

nlohmann::ordered_json FixedRotationJson(const PlanResult& plan, const ReportInputs& inputs) {
  const FixedComparison* const fixed = inputs.fixed;
  if (!fixed) return nullptr;
  const bool known = inputs.lost_motion && inputs.lost_motion->Known();
  const auto choice = [&](const FixedChoice& of, bool one_rotation) {
    FixedTree json = FixedOf(fixed->plan, of.figures);
    if (json.is_null()) return json;
    FixedTree degrees = FixedTree::array();
    for (const double rotation : of.rotations) degrees.push_back(RadToDeg(rotation));
    if (one_rotation)
      json["rotation_deg"] = degrees.at(0);
    else
      json["rotations_deg"] = degrees;
    json["reversals"] = TallyJson(plan.external_axes, of.gears, known);
    return json;
  };
  const auto text = [](const std::string& why) { return why.empty() ? FixedTree(nullptr) : FixedTree(why); };
  return {{"points", fixed->plan.points},
          {"job", choice(fixed->job, true)},
          {"passes", choice(fixed->passes, false)},
          {"job_by_sum", choice(fixed->job_by_sum, true)},
          {"passes_by_sum", choice(fixed->passes_by_sum, false)},
          {"job_by_length", choice(fixed->job_by_length, true)},
          {"passes_by_length", choice(fixed->passes_by_length, false)},
          {"plan_reversals", TallyJson(plan.external_axes, fixed->plan_gears, known)},
          {"in_the_way", {{"job", text(fixed->job_in_the_way)}, {"passes", text(fixed->passes_in_the_way)}}}};
}

}  // namespace millpose
