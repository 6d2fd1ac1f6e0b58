// SPDX-License-Identifier: GPL-3.0-or-later
// A job's inputs cut down to what a stage may read. The stage is handed nothing else, so whatever it reads is
// in the hash of what it is handed: a change of anything beside that cannot change its result.
#pragma once

#include "job/inputs.hpp"

namespace millpose {

/// For laying the tool path, its gouges and engagement: workpiece, tool path, what is cut, cutter and arm.
/// All else stands as by default.
JobInputs InputsOfToolpath(const JobInputs& inputs);

/// For the programs of one controller: without the other controllers, and what reports alone say of a plan.
JobInputs InputsOfProgram(const JobInputs& inputs, const std::string& controller);

/// Without where the cell's obstacles (IsObstacle) stand and what they are shaped like: for what learns of
/// them from a watched world alone.
JobInputs WithoutPlaces(JobInputs inputs);

}  // namespace millpose
