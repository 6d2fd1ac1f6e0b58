// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of `cells/` as they stand in the program, so that it needs no folder of its own to start from.
#pragma once

#include <string_view>
#include <vector>

namespace millpose {

struct SampleCell {
  std::string_view name;  ///< of the file, without ending
  std::string_view text;
  bool first;  ///< `init` can begin with it
};

/// All of them, by name. Made by embed.cmake.
const std::vector<SampleCell>& SampleCells();

}  // namespace millpose
