// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "base/progress.hpp"
#include "path/pass_planner.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/run.hpp"

namespace millpose {

struct PlannedPasses {
  std::vector<PassResult> passes;
  size_t resumed = 0;  ///< how many came from checkpoints
};

/// Plans every pass, in parallel. `context` is all that a pass depends on besides its points, as text: the
/// key of a pass's checkpoint is the hash of both. Each finished pass is written as a checkpoint at once, and
/// one whose checkpoint is there is not planned again. Passes outside `share` stay empty.
PlannedPasses PlanPasses(const PoseProblem& problem, const World& world, const Toolpath& toolpath,
                         const PathOptions& options, const std::string& context, const OutputFolder& folder,
                         const Share& share, int threads, Progress& progress, std::stop_token stop);

}  // namespace millpose
