// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/result/plan_result.hpp"
#include "planning/result/timeline.hpp"
#include "toolpath/stock/removal.hpp"

namespace millpose {

/// The raw part of a plan. Frame P, mm.
struct RawPart {
  Triangles blank;                            ///< its surface
  Triangles part;                             ///< that of the finished part
  const std::vector<CutsOfTool>& cut_before;  ///< what was taken off before the plan
  double resolution;                          ///< least distance of the lines
};

/// When a plan's run takes what off its raw part, on some 40,000 lines along the axis that the tool is
/// nearest to and in 1,200 frames at most. Throws Interrupted.
Removal PlanRemoval(const PlanResult& plan, const Timeline& timeline, const RawPart& raw,
                    const CutterShape& cutter, const Execution& execution);

/// What comes to a path that nobody has planned yet, and in one frame, that of 1 s, what its cuts leave: on
/// some 10,000 lines. Throws Interrupted.
Removal PathRemoval(const CutsOfTool& cuts, const RawPart& raw, const Execution& execution);

}  // namespace millpose
