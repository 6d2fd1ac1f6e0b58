// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace millpose::campaign {

/// "G commands" (list of groups): words and G codes of one group exclude each other in a block.
const std::map<std::string, int>& SinumerikGroups();

}  // namespace millpose::campaign
