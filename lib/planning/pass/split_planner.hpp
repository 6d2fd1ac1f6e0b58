// SPDX-License-Identifier: GPL-3.0-or-later
// Between PlanPass and PlanSegments: passes that have to be split are planned again with parts that overlap.
#pragma once

#include "planning/pass/overlap.hpp"
#include "planning/pass/segment_planner.hpp"

namespace millpose {

/// What is planned of a pass: its points, with those that splits add.
struct SplitPoints {
  std::vector<SplitPoint> points;
  std::vector<MillingPoint> milling;  ///< the same, for PassContext::points
  std::unique_ptr<PassContext> context;
};

struct SplitPass {
  std::shared_ptr<const SplitPoints> points;
  PassPlan plan;
  std::vector<int> uncut;  ///< points, of `points`, after which the step to the pass's next is not cut
  std::vector<int> lifts;  ///< pieces before which the tool is lifted because that pays
  double lift_gain = 0;    ///< share of the pass's objective that these gain, 0..1
};

/// Plans a pass whose points' optima are known (`own`: one SplitPoint per point, none added). Where two
/// neighbouring points end up in different pieces, it is planned again with an overlap there: the choices of
/// OverlapChoices one after the other, until the parts hold together. A ring left open (ring_opening.hpp) is
/// split where it begins. Then lifts that pay (FindLifts) are splits as well, kept where the plan with them
/// shows the gain. `first_point`: for random streams.
SplitPass PlanSplit(const Pass& pass, std::shared_ptr<const SplitPoints> own, size_t first_point);

/// Own optima of some points by both searches; the i-th has the random stream `stream` + i.
void FindOptima(std::span<const size_t> points, uint64_t stream, PassContext& context);

}  // namespace millpose
