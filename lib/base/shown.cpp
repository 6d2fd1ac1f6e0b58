// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shown.hpp"

namespace millpose {

std::string Shown(std::string_view text, size_t most) {
  const bool cut = text.size() > most;
  size_t end = cut ? most : text.size();
  const auto continues = [&] { return (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80; };
  while (cut && end > 0 && continues()) --end;  // no half a character
  std::string shown(text.substr(0, end));
  for (char& c : shown)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = '?';
  return cut ? shown + "…" : shown;
}

}  // namespace millpose
