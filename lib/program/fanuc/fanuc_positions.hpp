// SPDX-License-Identifier: GPL-3.0-or-later
// The records of /POS.
#pragma once

#include <string_view>

#include "program/fanuc/fanuc_file.hpp"

namespace millpose {

/// Reads the records in lines first … last − 1 of `file`; adds every problem with its place.
FanucPositions ReadFanucPositions(const std::string& file, const std::vector<std::string_view>& lines,
                                  size_t first, size_t last, const PostSettings& settings,
                                  const FanucOptions& options, std::vector<Problem>& problems);

}  // namespace millpose
