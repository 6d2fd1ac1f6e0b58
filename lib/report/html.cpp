// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html.hpp"

#include "report/html_data.hpp"
#include "report/page/escaped.hpp"
#include "report/page/web_page.hpp"
#include "report/web_assets.hpp"

namespace millpose {
std::string ReportHtml(const HtmlInput& input, const HtmlLimits& limits) {
  const std::string title = Escaped(input.Title()), data = ReportJson(input, limits),
                    language = WordOf(kLanguageWords, input.language);
  return FilledPage(kWebPage, {{"language", language},
                               {"title", title},
                               {"style", kWebStyle},
                               {"license", kWebLicense},
                               {"three", kWebThree},
                               {"scripts", kWebScripts},
                               {"words", kWordsOfPage},
                               {"data", data}});
}

}  // namespace millpose
