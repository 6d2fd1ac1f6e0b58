// SPDX-License-Identifier: GPL-3.0-or-later
// The direction of passes in a zigzag where a force acts: it has another side when the pass is run from its
// end.
#pragma once

#include "run/pipeline/stages/plan_job.hpp"
#include "run/pipeline/stages/plan_passes.hpp"

namespace millpose {

/// Whether the job leaves it to the planner which way its passes run.
bool FreeDirections(const JobSettings& job);

/// Whether what the poses of a job depend on knows the feed's direction, as a force does.
bool DependsOnFeed(const JobSettings& job, const Objective& objective);

/// Plans the `wanted` passes. In a zigzag whose poses depend on the feed, one that promises a gain from its
/// other end (FindPromisingReversals) is planned from there, and as it is laid too where the first plan
/// leaves open which is better (IsBetter); what is turned stands turned in `prepared` too. Throws
/// Interrupted.
PlannedPasses PlanBestWays(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                           const std::function<bool(size_t)>& wanted, const Execution& execution);

}  // namespace millpose
