// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "base/progress.hpp"
#include "path/gap_planner.hpp"
#include "path/pass_planner.hpp"
#include "pipeline/inputs.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/run.hpp"

namespace millpose {

/// Everything that a checkpoint depends on besides the points or poses it was planned for.
std::string PlanContext(const JobInputs& inputs);

struct PlannedPasses {
  std::vector<PassResult> passes;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every pass, in parallel. `context` is all that a pass depends on besides its points: the key of a
/// pass's checkpoint is the hash of both. Each finished pass is written as a checkpoint at once, and
/// one whose checkpoint is there is not planned again. Passes outside `share` stay empty.
PlannedPasses PlanPasses(const PoseProblem& problem, const World& world, const Toolpath& toolpath,
                         const PathOptions& options, const std::string& context, const OutputFolder& folder,
                         const Share& share, int threads, Progress& progress, std::stop_token stop);

struct PlannedGaps {
  std::vector<Gap> gaps;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every gap of passes whose turns are fixed, as PlanPasses does passes.
PlannedGaps PlanGaps(const World& world, const std::vector<std::pair<GapEnd, GapEnd>>& ends,
                     const GapOptions& options, const std::string& context, const OutputFolder& folder,
                     int threads, Progress& progress, std::stop_token stop);

}  // namespace millpose
