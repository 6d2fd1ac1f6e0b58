// SPDX-License-Identifier: GPL-3.0-or-later
// What report.html and check.html have in common.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace millpose {

/// The page with every {{name}} replaced by what `values` holds for it.
std::string FilledPage(std::string_view page, const std::map<std::string_view, std::string_view>& values);

}  // namespace millpose
