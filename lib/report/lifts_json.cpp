// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/lifts_json.hpp"

#include "base/units.hpp"

namespace millpose {

using Json = nlohmann::ordered_json;

Json StepJson(const PoseStep& step) {
  return {{"why", Name(step.why)},
          {"pass", step.pass},
          {"other_pass", step.other_pass},
          {"point", step.point},
          {"other_point", step.other},
          {"rotation_change_deg", RadToDeg(step.rotation)},
          {"other_branch", step.other_branch},
          {"height_mm", step.height}};
}

Json LiftsJson(const PlanResult& plan) {
  Json list = Json::array();
  size_t first = 0;  // of the pass, in the numbering of points.csv
  for (const PassResult& pass : plan.passes) {
    for (const int piece : pass.lifts)
      list.push_back({{"pass", pass.pass},
                      {"before_piece", piece},
                      {"point", first + static_cast<size_t>(pass.pieces[static_cast<size_t>(piece)].first)},
                      {"gain_percent_of_pass", 100 * pass.lift_gain}});
    first += pass.points.size();
  }
  return list;
}

Json OpenRingsJson(const PlanResult& plan) {
  Json list = Json::array();
  for (const PassResult& pass : plan.passes)
    if (pass.opened_at >= 0) list.push_back(pass.pass);
  return list;
}

Json StepsJson(const std::optional<PoseSteps>& steps) {
  if (!steps) return nullptr;
  Json parts = Json::array();
  for (const PoseStep& step : steps->parts) parts.push_back(StepJson(step));
  return {{"tip_uncertainty_mm", steps->tool.tip},
          {"axis_uncertainty_deg", RadToDeg(steps->tool.axis)},
          {"parts", parts},
          {"neighbours", steps->neighbours ? StepJson(*steps->neighbours) : Json(nullptr)}};
}

}  // namespace millpose
