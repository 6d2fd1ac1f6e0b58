// SPDX-License-Identifier: GPL-3.0-or-later
// What somebody does by hand before a job's programs run for the first time.
#pragma once

#include "job/inputs.hpp"

namespace millpose {

/// What is done by hand for the programs of one controller: what it is about, and what to do.
std::vector<std::pair<std::string, std::string>> FirstRunSteps(const JobInputs& inputs,
                                                               const std::string& controller);

/// A list for each controller that the job asks for: "krl, before a first run:" and a line for each step.
std::string FirstRunText(const JobInputs& inputs);

}  // namespace millpose
