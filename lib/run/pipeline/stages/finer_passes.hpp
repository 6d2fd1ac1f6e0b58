// SPDX-License-Identifier: GPL-3.0-or-later
// Points inserted on the surface where the steps between them are too large.
#pragma once

#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// Plans the `wanted` passes again whose steps keep their plan from being better (LargeSteps), with points
/// inserted where these are: on the same curve of the surface, half-way, and again half-way while that helps
/// or points are lost to steps. A pass keeps the points where its plan is better for them (IsBetter), in
/// `passes` and in `prepared.toolpath`. Paths that come from a file keep their points. Throws Interrupted.
void PlanFiner(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
               const std::function<bool(size_t)>& wanted, const Execution& execution,
               std::vector<PassResult>& passes);

}  // namespace millpose
