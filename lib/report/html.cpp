// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html.hpp"

#include "report/escaped.hpp"
#include "report/html_data.hpp"
#include "report/web_assets.hpp"

namespace millpose {
namespace {

/// The page with every {{name}} replaced by what `values` holds for it.
std::string Filled(std::string_view page, const std::map<std::string_view, std::string_view>& values) {
  std::string text;
  for (size_t at = 0;;) {
    const size_t open = page.find("{{", at), close = page.find("}}", open);
    text += page.substr(at, open - at);
    if (open == std::string_view::npos || close == std::string_view::npos) return text;
    text += values.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
}

}  // namespace

std::string ReportHtml(const HtmlInput& input, const HtmlLimits& limits) {
  const std::string title = Escaped(input.plan.job), data = ReportJson(input, limits);
  return Filled(kWebPage, {{"title", title},
                           {"style", kWebStyle},
                           {"license", kWebLicense},
                           {"three", kWebThree},
                           {"scripts", kWebScripts},
                           {"data", data}});
}

}  // namespace millpose
