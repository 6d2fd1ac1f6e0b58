// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose report`: the setup sheet of a plan, or of all operations of a job, from its output folder.
#pragma once

#include <stop_token>
#include <string>

#include "run/pipeline/commands/reported_folder.hpp"

namespace millpose {

/// HTML (SetupSheetHtml). Throws InputError for what cannot be read; Interrupted.
std::string SetupOfFolder(const SetupArguments& arguments, std::stop_token stop);

}  // namespace millpose
