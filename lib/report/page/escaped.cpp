// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page/escaped.hpp"

#include "base/text.hpp"

namespace millpose {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : ValidUtf8(text)) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (static_cast<unsigned char>(c) < 0x20 && c != '\n')  // not allowed in XML 1.0
      escaped += ' ';
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace millpose
