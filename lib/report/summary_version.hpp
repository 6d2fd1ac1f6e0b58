// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace millpose {

/// Throws InputError where a summary.json, given as text and read from the file `name`, is no JSON or of
/// another schema_version than this program writes.
void CheckSummaryVersion(const std::string& summary_json, const std::string& name);

}  // namespace millpose
