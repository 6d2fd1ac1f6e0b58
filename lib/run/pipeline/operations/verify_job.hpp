// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/programs/verify_programs.hpp"

namespace millpose {

/// VerifyPrograms(), also for the output folder of a job with several operations: the programs of each, then
/// the main programs, which must call them and hold them as they are. Takes no lock: a folder that another
/// run replaces meanwhile is read again (ReadWhole).
std::vector<VerifiedProgram> VerifyJob(const VerifyArguments& arguments, Progress& progress,
                                       std::stop_token stop);

}  // namespace millpose
