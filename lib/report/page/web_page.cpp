// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page/web_page.hpp"

namespace millpose {

std::string FilledPage(std::string_view page, const std::map<std::string_view, std::string_view>& values) {
  std::string text;
  for (size_t at = 0;;) {
    const size_t open = page.find("{{", at), close = page.find("}}", open);
    text += page.substr(at, open - at);
    if (open == std::string_view::npos || close == std::string_view::npos) return text;
    text += values.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
}

}  // namespace millpose
