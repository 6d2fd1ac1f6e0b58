// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose report --summary`: two pages to be signed, of a plan or of all operations of a job.
#pragma once

#include <string>

#include "run/pipeline/commands/reported_folder.hpp"

namespace millpose {

/// HTML (SummarySheetHtml). Every file of the folder must be as its manifest says, since hashes are signed.
/// Throws InputError for what cannot be read or was changed.
std::string SummaryOfFolder(const SetupArguments& arguments);

}  // namespace millpose
