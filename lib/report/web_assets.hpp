// SPDX-License-Identifier: GPL-3.0-or-later
// The front ends of report.html and check.html: the files of web/ and three.js, compiled in by
// web/embed.cmake.
#pragma once

#include <string_view>

namespace millpose {

extern const std::string_view kWebPage;     ///< web/page.html
extern const std::string_view kWebStyle;    ///< web/style.css
extern const std::string_view kWebLicense;  ///< web/three-license.txt
extern const std::string_view kWebThree;    ///< three.min.js
extern const std::string_view kWebScripts;  ///< web/*.js in the order of CMakeLists.txt

extern const std::string_view kWebCheckPage;     ///< web/check.html
extern const std::string_view kWebCheckScripts;  ///< those of check.html

extern const std::string_view kWordsOfPage;   ///< the tables of words that report.html carries
extern const std::string_view kWordsOfCheck;  ///< those that check.html carries beside them
extern const std::string_view kWordsOfSheet;  ///< those of the setup sheet and the terminal's summary

}  // namespace millpose
