// SPDX-License-Identifier: GPL-3.0-or-later
// What messages repeat of foreign files: little.
#pragma once

#include <string>
#include <string_view>

namespace millpose {

/// Problems that one error lists; more are not looked for.
inline constexpr size_t kMostProblems = 50;

/// Text of a foreign file as messages show it: one line, at most `most` bytes (then "…"), control characters
/// and what is no UTF-8 as "?".
std::string Shown(std::string_view text, size_t most = 60);

}  // namespace millpose
