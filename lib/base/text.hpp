// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// 0 to 9.
inline bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// The shortest decimal text that reads back as the same double.
std::string ShortestNumber(double value);

/// A finite decimal number that fills the whole of `text` (no spaces, no hex, no inf or nan), by
/// std::from_chars and so free of the locale; empty when it is not one.
std::optional<double> ParseNumber(std::string_view text);

/// The text with every byte that is not part of valid UTF-8 replaced by U+FFFD: names of files need not be,
/// JSON and XML must be.
std::string ValidUtf8(std::string_view text);

}  // namespace millpose
