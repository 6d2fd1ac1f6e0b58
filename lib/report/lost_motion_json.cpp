// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/lost_motion_json.hpp"

#include "base/units.hpp"
#include "planning/result/continuity.hpp"

namespace millpose {
namespace {

using ReversalJson = nlohmann::ordered_json;

constexpr double kMicrometresPerMm = 1000;

bool IsLinear(const std::vector<ExternalAxis>& external, int gear) {
  return gear >= 6 && external[static_cast<size_t>(gear) - 6].kind == AxisKind::kLinear;
}

ReversalJson GearJointsJson(const PlanResult& plan, const LostMotionReport& report) {
  ReversalJson joints = ReversalJson::array();
  for (size_t i = 0; i < 6 + plan.external_axes.size(); ++i) {
    const int gear = static_cast<int>(i);
    const bool linear = IsLinear(plan.external_axes, gear);
    const double width = report.model.lost.width[gear];
    const double shown = linear ? kMicrometresPerMm * width : 60 * RadToDeg(width);
    joints.push_back({{"joint", AxisName(plan.external_axes, gear)},
                      {"count", report.tally.turns[i]},
                      {"crossings", report.tally.crossings[i]},
                      {linear ? "lost_motion_um" : "lost_motion_arcmin",
                       report.model.known[i] ? ReversalJson(shown) : ReversalJson(nullptr)}});
  }
  return joints;
}

ReversalJson GearPassesJson(const PlanResult& plan, const LostMotionReport& report) {
  std::map<int, std::vector<int>> counts;
  for (const GearMark& mark : report.course.marks)
    if (mark.turns) {
      std::vector<int>& of_pass = counts[mark.pass];
      of_pass.resize(6 + plan.external_axes.size());
      ++of_pass[static_cast<size_t>(mark.gear)];
    }
  ReversalJson passes = ReversalJson::array();
  for (const auto& [pass, of_pass] : counts) passes.push_back({{"pass", pass}, {"counts", of_pass}});
  return passes;
}

ReversalJson MarksJson(const PlanResult& plan, const LostMotionReport& report) {
  ReversalJson places = ReversalJson::array();
  for (const GearMark& mark : report.course.marks) {
    const std::optional<double> height = HeightOf(mark, report.model);
    places.push_back(
        {{"point", mark.point},
         {"pass", mark.pass},
         {"joint", AxisName(plan.external_axes, mark.gear)},
         {"turns_back", mark.turns},
         {"crosses", mark.crosses},
         {IsLinear(plan.external_axes, mark.gear) ? "um_per_um" : "um_per_arcmin",
          kMicrometresPerMm * HeightPerUnit(mark, plan.external_axes)},
         {"mark_um", height ? ReversalJson(kMicrometresPerMm * *height) : ReversalJson(nullptr)}});
  }
  return places;
}

}  // namespace

nlohmann::ordered_json TallyJson(const std::vector<ExternalAxis>& external, const GearTally& tally,
                                 bool known) {
  const auto counts = [&](const std::array<int, kMostGears>& of) {
    return std::vector<int>(of.begin(), of.begin() + 6 + static_cast<std::ptrdiff_t>(external.size()));
  };
  return {
      {"counts", counts(tally.turns)},
      {"crossings", counts(tally.crossings)},
      {"total", tally.Turns()},
      {"marks_are_per_arcmin", !known},
      {"largest_mark_um", kMicrometresPerMm * tally.largest},
      {"marks_sum_um", kMicrometresPerMm * tally.sum},
      {"largest_error_um", known ? ReversalJson(kMicrometresPerMm * tally.worst) : ReversalJson(nullptr)}};
}

nlohmann::ordered_json ReversalsJson(const PlanResult& plan, const LostMotionReport& report) {
  ReversalJson json{{"dead_zone_deg", RadToDeg(report.model.lost.dead_zone[0])}};
  json.update(TallyJson(plan.external_axes, report.tally, report.Known()));
  json["lost_motion_source"] = report.source.empty() ? ReversalJson(nullptr) : ReversalJson(report.source);
  json["load_is_known"] = report.model.weights.has_value();
  json["joints"] = GearJointsJson(plan, report);
  json["passes"] = GearPassesJson(plan, report);
  json["places"] = MarksJson(plan, report);
  return json;
}

}  // namespace millpose
