// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// A reader of bytes from outside. It may refuse them with InputError; whatever else happens is a fault, also
/// a result that breaks what the reader promises (then std::abort).
struct FuzzEntry {
  std::string name;
  void (*run)(std::string_view bytes);
};

/// Every own reader.
const std::vector<FuzzEntry>& FuzzEntries();

}  // namespace millpose
