// SPDX-License-Identifier: GPL-3.0-or-later
// What the words of G-code mean for the path of the tip. docs/cam-import.md.
#pragma once

#include <string_view>

namespace millpose {

enum class GcodeMeaning : uint8_t {
  kUnknown,
  kHarmless,  ///< says nothing about the path
  kRefused,   ///< changes the path in a way that is not read
};

/// Of a G number that GcodeReader does not treat itself.
GcodeMeaning MeaningOfG(double number);
/// Of a name, alone or with parentheses. Unknown names may be subprogrammes.
GcodeMeaning MeaningOfName(std::string_view name);

}  // namespace millpose
