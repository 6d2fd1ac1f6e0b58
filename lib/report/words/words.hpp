// SPDX-License-Identifier: GPL-3.0-or-later
// What pages and the terminal's summary say in other languages: finished English texts are looked up in the
// tables beside this file (docs/languages.md).
#pragma once

#include <string>
#include <string_view>

#include "base/enum_words.hpp"

namespace millpose {

enum class Language { kEnglish, kGerman, kChinese };
/// As --lang, the page's menu and its attribute `lang` have them.
inline constexpr EnumWords<Language, 3> kLanguageWords = {
    {{"en", Language::kEnglish}, {"de", Language::kGerman}, {"zh", Language::kChinese}}};

/// The language called `word`. Throws InputError, with the known words and the nearest, for any other.
Language ParseLanguage(const std::string& word);

/// `english`, a whole text or several sentences, in a language: figures, units and names as they stand. What
/// no table has stays English, sentence by sentence. A pure function of its arguments: no locale.
std::string Say(Language language, std::string_view english);

/// Whether all of `english` has its words in the tables; true of texts without letters.
bool CanSay(std::string_view english);

/// The text that `plan` prints (BriefText), line by line, with the words before them in their column.
std::string SayBrief(Language language, std::string_view brief);

}  // namespace millpose
