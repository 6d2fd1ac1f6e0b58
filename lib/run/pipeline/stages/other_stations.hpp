// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// Plans those of the `wanted` passes that lose points where the external axes stand, or (where the worst
/// point counts first) pay there for joining their poses, once more at the next stations
/// (`prepared.elsewhere`), one after the other; those along which axes move at the best station that stands.
/// A pass goes where its plan is better so (IsBetter), in `passes`, `prepared.toolpath` and
/// `prepared.external`. Throws Interrupted.
void PlanOtherStations(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                       const std::function<bool(size_t)>& wanted, const Execution& execution,
                       std::vector<PassResult>& passes);

}  // namespace millpose
