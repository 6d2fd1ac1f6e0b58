// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shown.hpp"

#include <algorithm>

namespace millpose {
namespace {

// Bytes of the character of UTF-8 that begins at `at`; 0 where none does.
size_t CharacterAt(std::string_view text, size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  const size_t length = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (first > 0xf4 || at + length > text.size()) return 0;
  for (size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[at + i]) & 0xc0) != 0x80) return 0;
  // Longer than needed, half a pair of UTF-16, beyond the last character.
  const auto second = length > 2 ? static_cast<unsigned char>(text[at + 1]) : 0;
  const bool wrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                     (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
  return wrong ? 0 : length;
}

bool IsControl(char c) { return (c >= 0 && c < ' ') || c == 0x7f; }

}  // namespace

std::string Shown(std::string_view text, size_t most) {
  std::string shown;
  for (size_t at = 0; at < text.size();) {
    const size_t length = CharacterAt(text, at);
    if (at + std::max<size_t>(length, 1) > most) return shown + "…";
    shown += length == 0 || IsControl(text[at]) ? "?" : text.substr(at, length);
    at += std::max<size_t>(length, 1);
  }
  return shown;
}

}  // namespace millpose
