// SPDX-License-Identifier: GPL-3.0-or-later
// What somebody does by hand before a job's programs run for the first time.
#pragma once

#include "job/inputs.hpp"

namespace millpose {

/// A list for each controller that the job asks for: "krl, before a first run:" and a line for each step.
std::string FirstRunText(const JobInputs& inputs);

}  // namespace millpose
