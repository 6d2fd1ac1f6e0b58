// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace millpose {

/// The words of an enum in files and messages: one table for reading, writing, schema and texts.
template <class E, size_t kCount>
using EnumWords = std::array<std::pair<std::string_view, E>, kCount>;

/// The word of a value that the table has.
template <class E, size_t kCount>
std::string WordOf(const EnumWords<E, kCount>& words, E value) {
  for (const auto& [word, named] : words)
    if (named == value) return std::string(word);
  return {};
}

}  // namespace millpose
