// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.hpp"

#include <charconv>

namespace millpose {

std::string ShortestNumber(double value) { return fmt::format("{}", value); }

std::optional<double> ParseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace millpose
