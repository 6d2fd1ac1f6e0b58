// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "run/pipeline/programs/verify_programs.hpp"

namespace millpose {

/// A program, or a main program of operations and all that it calls, with a cell and no plan. Throws
/// InputError.
std::vector<VerifiedProgram> VerifyAlone(const VerifyArguments& arguments, const Execution& execution);

}  // namespace millpose
