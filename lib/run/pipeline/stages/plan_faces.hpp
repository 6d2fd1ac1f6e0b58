// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/face_planner.hpp"
#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// Plans the passes of a job whose objective judges whole ways by the error of the face: first how large the
/// largest displacement of the job must be (AttainableFace), then every pass beneath that (PlanFace). Where
/// directions are free, passes that would exceed the others are tried from their other end; where the step
/// between two neighbours is larger than any displacement, all are, and fixed rotations beside them
/// (ChooseSequence). What runs the other way stands so in `prepared` too. Passes of
/// other jobs stay as they are, and so do those of layers that later ones mill away. Each pass is cached as a
/// stage. What was chosen comes back by pass. Throws Interrupted.
std::vector<FaceChoice> PlanFaces(const JobInputs& inputs, PreparedJob& prepared,
                                  const CheckpointStore& checkpoints, const Execution& execution,
                                  std::vector<PassResult>& passes);

}  // namespace millpose
