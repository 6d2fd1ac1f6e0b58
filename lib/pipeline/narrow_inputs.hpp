// SPDX-License-Identifier: GPL-3.0-or-later
// A job's inputs cut down to what a stage may read. The stage is handed nothing else, so whatever it reads is
// in the hash of what it is handed: a change of anything beside that cannot change its result.
#pragma once

#include "pipeline/inputs.hpp"

namespace millpose {

/// For laying the tool path, its gouges and engagement: workpiece, tool path, what is cut, cutter and arm.
/// All else stands as by default.
JobInputs InputsOfToolpath(const JobInputs& inputs);

/// For the programs of one controller: without the other controllers, and what reports alone say of a plan.
JobInputs InputsOfProgram(const JobInputs& inputs, const std::string& controller);

}  // namespace millpose
