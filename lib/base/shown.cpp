// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shown.hpp"

#include <algorithm>

#include "base/utf8.hpp"

namespace millpose {
namespace {

bool IsControl(char c) { return (c >= 0 && c < ' ') || c == 0x7f; }

}  // namespace

std::string Shown(std::string_view text, size_t most) {
  std::string shown;
  for (size_t at = 0; at < text.size();) {
    const size_t length = Utf8Length(text.substr(at));
    if (at + std::max<size_t>(length, 1) > most) return shown + "…";
    shown += length == 0 || IsControl(text[at]) ? "?" : text.substr(at, length);
    at += std::max<size_t>(length, 1);
  }
  return shown;
}

}  // namespace millpose
