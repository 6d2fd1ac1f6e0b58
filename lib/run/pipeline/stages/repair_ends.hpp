// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/stages/plan_passes.hpp"

namespace millpose {

/// Passes, where they are milled, and under which name what is found of their ends is kept.
struct PassesWithEnds {
  const Stations& stations;
  const Toolpath& toolpath;
  const std::vector<ExternalCourse>& external;
  const char* stage = "ends";
};

/// Plans passes again of which the tool cannot leave or come to an end with all of the cell's clearances,
/// now with free retracts asked of their ends (EndGuard). A pass is replaced where it then loses fewer
/// points, or as many with more clearance and no further lift.
void RepairEnds(const PassesWithEnds& of, PathOptions options, const RetractOptions& leave,
                const CheckpointStore& checkpoints, const Execution& execution,
                std::vector<PassResult>& passes);

}  // namespace millpose
