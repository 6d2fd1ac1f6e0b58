// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/random.hpp"

namespace millpose {

/// Spoils a text or binary file as the stream says: changed, lost, doubled and moved bytes, cut ends, and
/// numbers that readers must not trust.
inline std::string Mutated(std::string bytes, RandomStream& random) {
  static const char* const kNasty[] = {
      "nan", "inf", "-1",   "4294967295", "1e400", "0",  "-0.0", "99999999999999999999",
      "",    "\n",  "\r\n", "$",          "/",     "\"", "f",    "\xff\xff\xff\xff"};
  const int edits = 1 + random.Below(6);
  for (int i = 0; i < edits && !bytes.empty(); ++i) {
    const auto at = static_cast<size_t>(random.Below(static_cast<int>(bytes.size())));
    const auto length = std::min<size_t>(bytes.size() - at, static_cast<size_t>(1 + random.Below(40)));
    switch (random.Below(6)) {
      case 0:
        bytes[at] = static_cast<char>(random.Below(256));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.replace(at, length, kNasty[random.Below(16)]);
        break;
      default:
        bytes.insert(at, kNasty[random.Below(16)]);
    }
  }
  return bytes;
}

}  // namespace millpose
