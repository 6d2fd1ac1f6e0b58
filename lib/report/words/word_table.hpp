// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of words, parsed.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "report/words/words.hpp"

namespace millpose {

/// What may stand at a place of an English text: {} a name, as it stands; {#} a figure; {say} words that the
/// tables have; {any} words that they may have. kEnd: no place, the text ends.
enum class WordPlace { kName, kNumber, kWords, kAny, kEnd };

struct WordPiece {
  std::string before;  ///< text before the place
  WordPlace place = WordPlace::kEnd;
};

struct WordEntry {
  std::string english, german, chinese;  ///< in the others {1}, {2} … are the places of the English text
  std::string tip;                       ///< of what it says what it means; empty: no tip
  int line = 0;                          ///< of the English text in its table
  std::vector<WordPiece> pieces = {};    ///< of the English text

  const std::string& In(Language language) const {
    return language == Language::kGerman ? german : language == Language::kChinese ? chinese : english;
  }
};

class WordTable {
 public:
  explicit WordTable(std::vector<WordEntry> entries);

  /// The text without places that is `english`; null where there is none.
  const WordEntry* Exact(std::string_view english) const;
  /// Texts with places, those with the most text of their own first.
  const std::vector<WordEntry>& patterns() const { return patterns_; }

 private:
  std::map<std::string, WordEntry, std::less<>> exact_;
  std::vector<WordEntry> patterns_;
};

/// Entries of a table: lines "en …", "de …", "zh …", before them "tip …" where it is one; blank lines and
/// lines that begin with # part them. Throws InputError with name and line for anything else.
std::vector<WordEntry> ParseWords(std::string_view text, const std::string& name);

/// All tables of the program.
const WordTable& Words();

/// Without their ends; none after the last "\n".
std::vector<std::string_view> LinesOf(std::string_view text);

/// Columns that a text takes in a terminal, or in letters of one width: two for each sign of Chinese.
size_t ColumnsOf(std::string_view text);

/// Whether a text has letters, and not figures and signs alone.
bool HasLetters(std::string_view text);
/// One or several figures, with signs, without units.
bool IsFigure(std::string_view text);

}  // namespace millpose
