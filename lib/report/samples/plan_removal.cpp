// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/samples/plan_removal.hpp"

#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr size_t kMostLines = 40'000;
constexpr size_t kMostFrames = 1'200;
constexpr size_t kMostLinesUnplanned = 10'000;

/// From point to point of the pieces; the first point of each as a motion that stands.
std::vector<TimedMotion> CutsInTime(const PlanResult& plan, const Timeline& timeline) {
  std::vector<TimedMotion> cuts;
  const RunInstant* before = nullptr;
  for (const RunInstant& instant : timeline) {
    if (instant.point < 0) {
      before = nullptr;
      continue;
    }
    const Pose X_PT =
        ToolAt(plan, plan.passes[static_cast<size_t>(instant.pass)], static_cast<size_t>(instant.point));
    const CutterPlace here{X_PT.translation(), X_PT.linear().col(2)};
    const bool cut = instant.stretch == RunPart::kCut || instant.stretch == RunPart::kLead;
    cuts.push_back({{cut && before ? cuts.back().motion.to : here, here, 0}, instant.time});
    before = &instant;
  }
  return cuts;
}

/// The raw part as it comes, on at most so many lines along the axis that the tool is nearest to.
StandingStock Coming(const RawPart& raw, size_t most_lines, std::span<const TimedMotion> cuts,
                     const Execution& execution) {
  StandingStock stock(raw.blank, raw.resolution, most_lines, AxisOfLines(cuts));
  for (const CutsOfTool& done : raw.cut_before)
    stock.Remove(done.cutter, done.motions, execution.Threads(), execution.stop);
  return stock;
}

}  // namespace

Removal PlanRemoval(const PlanResult& plan, const Timeline& timeline, const RawPart& raw,
                    const CutterShape& cutter, const Execution& execution) {
  const std::vector<TimedMotion> cuts = CutsInTime(plan, timeline);
  return WatchRemoval(Coming(raw, kMostLines, cuts, execution), raw.part, cutter, cuts, kMostFrames,
                      execution.Threads(), execution.stop);
}

Removal PathRemoval(const CutsOfTool& cuts, const RawPart& raw, const Execution& execution) {
  constexpr double kDone = 1;  // s
  std::vector<TimedMotion> motions;
  motions.reserve(cuts.motions.size());
  for (const CutterMotion& motion : cuts.motions) motions.push_back({motion, kDone});
  Removal removal = WatchRemoval(Coming(raw, kMostLinesUnplanned, motions, execution), raw.part, cuts.cutter,
                                 motions, 1, execution.Threads(), execution.stop);
  if (removal.frames.empty()) removal.frames.push_back({kDone, removal.volume, 0});  // nothing is cut
  return removal;
}

}  // namespace millpose
