// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/external/external_course.hpp"
#include "planning/links/link_move_planner.hpp"
#include "planning/pass/pass_planner.hpp"
#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

struct PlannedPasses {
  std::vector<PassResult> passes;
  size_t resumed = 0;  ///< how many came from checkpoints
};

struct PassesToPlan {
  const Toolpath& toolpath;
  const std::vector<ExternalCourse>& external;  ///< of each pass
  std::function<bool(size_t)> wanted;           ///< by number; passes that are not stay empty
};

/// Plans passes in parallel. Each finished pass is written as a checkpoint at once (checkpoint_key.hpp), and
/// one whose checkpoint is there is not planned again.
PlannedPasses PlanPasses(const Stations& stations, const PassesToPlan& request, const PathOptions& options,
                         const CheckpointStore& checkpoints, const Execution& execution);

struct PlannedLinkMoves {
  std::vector<LinkMove> gaps;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every gap of passes whose turns are fixed, as PlanPasses does passes.
PlannedLinkMoves PlanLinkMoves(const Stations& stations,
                               const std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>>& ends,
                               const LinkMoveOptions& options, const CheckpointStore& checkpoints,
                               const Execution& execution);

}  // namespace millpose
