// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "base/progress.hpp"
#include "path/gap_planner.hpp"
#include "path/pass_planner.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/run.hpp"

namespace millpose {

/// Where finished passes and gaps are kept, and whether earlier ones may be taken from there.
struct CheckpointUse {
  const OutputFolder& folder;
  bool read = true;
};

struct PlannedPasses {
  std::vector<PassResult> passes;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every pass, in parallel. Each finished pass is written as a checkpoint at once (checkpoint_key.hpp),
/// and one whose checkpoint is there is not planned again. Passes outside `share` stay empty.
PlannedPasses PlanPasses(const PoseProblem& problem, const World& world, const Toolpath& toolpath,
                         const PathOptions& options, const CheckpointUse& checkpoints, const Share& share,
                         int threads, Progress& progress, std::stop_token stop);

struct PlannedGaps {
  std::vector<Gap> gaps;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every gap of passes whose turns are fixed, as PlanPasses does passes.
PlannedGaps PlanGaps(const World& world, const std::vector<std::pair<GapEnd, GapEnd>>& ends,
                     const GapOptions& options, const CheckpointUse& checkpoints, int threads,
                     Progress& progress, std::stop_token stop);

}  // namespace millpose
