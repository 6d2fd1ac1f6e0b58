// SPDX-License-Identifier: GPL-3.0-or-later
// The shell of pages that are tables and text: the index of a batch, operations, places, what two plans
// differ in.
#pragma once

#include <string>
#include <string_view>

#include "report/words/words.hpp"

namespace millpose {

/// From <!DOCTYPE> to <body>: colours of light, dark and print, and how text and tables look; `style` is the
/// page's own, after that. The title is text, as it is in `language`.
std::string TablePageHead(std::string_view title, std::string_view style,
                          Language language = Language::kEnglish);

}  // namespace millpose
