// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace millpose {

/// "1 pass", "2 passes": a number with the word for one or for several.
template <class Number>
std::string Counted(Number count, std::string_view one, std::string_view several) {
  return fmt::format("{} {}", count, count == 1 ? one : several);
}

/// The same of passes, which are counted most.
template <class Number>
std::string CountedPasses(Number count) {
  return Counted(count, "pass", "passes");
}

}  // namespace millpose
