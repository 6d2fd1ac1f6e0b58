// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// Plans the passes of a job whose objective judges whole ways by the error of the face (PlanFace); others
/// stay as they are, and so do passes of layers that later ones mill away. Each pass is kept as a stage.
/// Throws Interrupted.
void PlanFaces(const JobInputs& inputs, const PreparedJob& prepared, const CheckpointStore& checkpoints,
               const Execution& execution, std::vector<PassResult>& passes);

}  // namespace millpose
