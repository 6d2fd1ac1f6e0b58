// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/words/word_table.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "report/web_assets.hpp"

namespace millpose {
namespace {

std::vector<WordPiece> PiecesOf(const std::string& english) {
  std::vector<WordPiece> pieces;
  for (size_t at = 0;;) {
    const size_t open = english.find('{', at), close = english.find('}', open);
    if (open == std::string::npos || close == std::string::npos) {
      pieces.push_back({english.substr(at), WordPlace::kEnd});
      return pieces;
    }
    const std::string word = english.substr(open + 1, close - open - 1);
    const WordPlace place = word == "#"     ? WordPlace::kNumber
                            : word == "say" ? WordPlace::kWords
                            : word == "any" ? WordPlace::kAny
                                            : WordPlace::kName;
    pieces.push_back({english.substr(at, open - at), place});
    at = close + 1;
  }
}

size_t OwnText(const WordEntry& entry) {
  size_t size = 0;
  for (const WordPiece& piece : entry.pieces) size += piece.before.size();
  return size;
}

}  // namespace

WordTable::WordTable(std::vector<WordEntry> entries) {
  for (WordEntry& entry : entries) {
    if (entry.pieces.size() == 1)
      exact_.emplace(entry.english, std::move(entry));
    else
      patterns_.push_back(std::move(entry));
  }
  std::ranges::stable_sort(patterns_, std::greater(), OwnText);
}

const WordEntry* WordTable::Exact(std::string_view english) const {
  const auto found = exact_.find(english);
  return found == exact_.end() ? nullptr : &found->second;
}

std::vector<WordEntry> ParseWords(std::string_view text, const std::string& name) {
  std::vector<WordEntry> entries;
  std::string tip;
  int number = 0;
  for (const std::string_view line : LinesOf(text)) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    const size_t blank = line.find(' ');
    const std::string_view key = line.substr(0, blank);
    const std::string said(blank == std::string_view::npos ? "" : line.substr(blank + 1));
    const bool open = !entries.empty() && entries.back().chinese.empty();
    if (key == "tip" && !open)
      tip = said;
    else if (key == "en" && !open)
      entries.push_back({said, "", "", std::exchange(tip, ""), number, PiecesOf(said)});
    else if (key == "de" && open && entries.back().german.empty())
      entries.back().german = said;
    else if (key == "zh" && open && !entries.back().german.empty())
      entries.back().chinese = said;
    else
      throw InputError({name, number, 1}, "is no entry: allowed: en, then de, then zh; tip before en");
  }
  if (!entries.empty() && entries.back().chinese.empty())
    throw InputError({name, number, 1}, "ends within an entry");
  return entries;
}

const WordTable& Words() {
  static const WordTable table = [] {
    std::vector<WordEntry> all = ParseWords(kWordsOfPage, "page");
    std::ranges::move(ParseWords(kWordsOfCheck, "check"), std::back_inserter(all));
    std::ranges::move(ParseWords(kWordsOfSheet, "sheet"), std::back_inserter(all));
    return WordTable(std::move(all));
  }();
  return table;
}

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

size_t ColumnsOf(std::string_view text) {
  size_t columns = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) != 0x80) columns += byte >= 0xE3 && byte < 0xF0 ? 2 : 1;
  }
  return columns;
}

bool HasLetters(std::string_view text) {
  return std::ranges::any_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
}

bool IsFigure(std::string_view text) {
  bool figure = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool digit = c >= '0' && c <= '9';
    figure |= digit || text == "-" || text == "–";
    const bool exponent = c == 'e' && i > 0 && text[i - 1] >= '0' && text[i - 1] <= '9';
    if (!digit && !exponent && static_cast<unsigned char>(c) < 0x80 &&
        std::string_view("+-.,/: %").find(c) == std::string_view::npos)
      return false;
  }
  return figure;
}

}  // namespace millpose
