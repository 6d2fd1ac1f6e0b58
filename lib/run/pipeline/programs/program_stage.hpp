// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "store/checkpoints.hpp"

namespace millpose {

struct PlannedJob;

/// Makes and checks the programs of a planned job, and those of its single pieces: of every controller, or
/// takes what the last run made and confirmed for it of the same plan, inputs (InputsOfProgram) and cell.
/// Programs name the hash of these inputs.
void MakeJobPrograms(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
                     PlannedJob& job);

}  // namespace millpose
