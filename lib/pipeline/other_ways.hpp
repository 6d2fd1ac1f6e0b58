// SPDX-License-Identifier: GPL-3.0-or-later
// The direction of passes in a zigzag where a force acts: it has another side when the pass is run from its
// end.
#pragma once

#include "pipeline/plan_job.hpp"

namespace millpose {

/// Whether the job leaves it to the planner which way its passes run.
bool FreeDirections(const JobSettings& job);

/// Whether what the poses of a job depend on knows the feed's direction, as a force does.
bool DependsOnFeed(const JobSettings& job, const Objective& objective);

/// In a zigzag whose poses depend on the feed, plans those of the `wanted` passes once more, run from their
/// end with the force of that way, whose points could gain by it. A pass is turned round where its plan is
/// better so (IsBetter), in `passes` and in `prepared.toolpath`; a warning names them. Throws Interrupted.
void PlanOtherWays(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                   const std::function<bool(size_t)>& wanted, const Execution& execution,
                   std::vector<PassResult>& passes);

}  // namespace millpose
