// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/lost_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/units.hpp"
#include "planning/result/continuity.hpp"

namespace millpose {

bool LostMotionReport::Known() const {
  if (course.marks.empty()) return model.known[0];
  return std::ranges::all_of(
      course.marks, [this](const GearMark& mark) { return model.known[static_cast<size_t>(mark.gear)]; });
}

LostMotionReport ReportLostMotion(const PlanResult& plan, GearModel model, std::string source,
                                  int finished_from) {
  LostMotionReport report{std::move(model), std::move(source), {}, {}};
  report.course = FollowGears(plan, report.model, OfFace(plan.passes, finished_from));
  report.tally = TallyOf(report.course, report.model, plan.external_axes);
  return report;
}

std::string CountsText(const std::vector<ExternalAxis>& external, const std::array<int, kMostGears>& counts) {
  std::vector<std::string> parts;
  for (size_t i = 0; i < 6 + external.size(); ++i)
    if (counts[i] > 0)
      parts.push_back(fmt::format("{} {}", AxisName(external, static_cast<int>(i)), counts[i]));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string MarksText(const GearTally& tally, bool known) {
  const double scale = 1e3;
  return fmt::format("at most {:.3g} µm, {:.0f} µm summed{}", scale * tally.largest, scale * tally.sum,
                     known ? "" : ", for each arcmin");
}

std::string LostMotionText(const PlanResult& plan, const LostMotionReport& report) {
  const GearTally& tally = report.tally;
  const int turns = tally.Turns();
  std::string text = turns == 0 ? "no joint turns back in cuts of the face"
                                : fmt::format("{} in cuts of the face ({})", turns,
                                              CountsText(plan.external_axes, tally.turns));
  if (report.model.weights)
    text += fmt::format(", {} cross their gap under load",
                        std::accumulate(tally.crossings.begin(), tally.crossings.end(), 0));
  if (!report.course.marks.empty())
    text += fmt::format("; marks along the normal {}", MarksText(tally, report.Known()));
  if (!report.Known())
    text += turns == 0 ? "" : " of lost motion, which the cell does not state (arm.lost_motion_arcmin)";
  else if (!report.source.empty() && turns > 0)
    text += fmt::format("; lost motion: {}", report.source);
  return text;
}

}  // namespace millpose
