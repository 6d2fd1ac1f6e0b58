// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "path/external_course.hpp"
#include "path/gap_planner.hpp"
#include "path/pass_planner.hpp"
#include "pipeline/plan_job.hpp"

namespace millpose {

struct PlannedPasses {
  std::vector<PassResult> passes;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every pass in parallel, with the external axes as its entry of `external` says. Each finished pass
/// is written as a checkpoint at once (checkpoint_key.hpp), and one whose checkpoint is there is not planned
/// again. Passes whose numbers are not `wanted` stay empty.
PlannedPasses PlanPasses(const Stations& stations, const std::vector<ExternalCourse>& external,
                         const Toolpath& toolpath, const PathOptions& options,
                         const CheckpointStore& checkpoints, const std::function<bool(size_t)>& wanted,
                         const Execution& execution);

struct PlannedGaps {
  std::vector<Gap> gaps;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every gap of passes whose turns are fixed, as PlanPasses does passes.
PlannedGaps PlanGaps(const Stations& stations, const std::vector<std::pair<GapEnd, GapEnd>>& ends,
                     const GapOptions& options, const CheckpointStore& checkpoints,
                     const Execution& execution);

}  // namespace millpose
