// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/words/words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/words/word_table.hpp"

namespace millpose {
namespace {

constexpr size_t kLabelWidth = 10;  // of BriefText, columns

/// Finds texts in the tables; language.js does the same in the page.
class Teller {
 public:
  Teller(const WordTable& table, Language language) : table_(table), language_(language) {}

  /// Empty where any part of it is missing.
  std::optional<std::string> Find(std::string_view english) {
    if (!HasLetters(english)) return std::string(english);
    const auto known = known_.find(english);
    if (known != known_.end()) return known->second;
    return known_.emplace(english, FindAnew(english)).first->second;
  }

 private:
  using Captures = std::vector<std::string_view>;

  std::optional<std::string> FindAnew(std::string_view english) {
    if (const WordEntry* entry = table_.Exact(english)) return entry->In(language_);
    for (const WordEntry& entry : table_.patterns()) {
      Captures captures;
      if (Match(entry, 0, english, captures)) return Filled(entry, captures);
    }
    for (const char* separator : {"; ", ", "})
      if (english.find(separator) != std::string_view::npos) return FindList(english, separator);
    return std::nullopt;
  }

  /// Whether pieces k and on of a pattern are `text`; the shortest captures first.
  bool Match(const WordEntry& entry, size_t k, std::string_view text, Captures& captures) {
    const WordPiece& piece = entry.pieces[k];
    if (!text.starts_with(piece.before)) return false;
    text.remove_prefix(piece.before.size());
    if (piece.place == WordPlace::kEnd) return text.empty();
    const WordPiece& next = entry.pieces[k + 1];
    const bool last = next.before.empty();  // no two places touch
    for (size_t end = last ? text.size() : text.find(next.before, 1);
         end != std::string_view::npos && end > 0; end = last ? 0 : text.find(next.before, end + 1)) {
      captures.push_back(text.substr(0, end));
      if (Fits(piece.place, captures.back()) && Match(entry, k + 1, text.substr(end), captures)) return true;
      captures.pop_back();
    }
    return false;
  }

  bool Fits(WordPlace place, std::string_view capture) {
    if (place == WordPlace::kNumber) return IsFigure(capture);
    const auto has = [&](const char* what) { return capture.find(what) != std::string_view::npos; };
    if (has(". ")) return false;  // no place takes several sentences, a name not even a list
    if (place == WordPlace::kWords) return Find(capture).has_value();
    return place == WordPlace::kAny || (!has(", ") && !has("; "));
  }

  std::string Filled(const WordEntry& entry, const Captures& captures) {
    const std::string& said = entry.In(language_);
    std::string text;
    for (size_t at = 0;;) {
      const size_t open = said.find('{', at), close = said.find('}', open);
      text += said.substr(at, open - at);
      if (open == std::string::npos || close == std::string::npos) return text;
      const auto place = static_cast<size_t>(*ParseNumber(said.substr(open + 1, close - open - 1))) - 1;
      text += Placed(entry.pieces.at(place).place, captures.at(place));
      at = close + 1;
    }
  }

  std::string Placed(WordPlace place, std::string_view capture) {
    std::optional<std::string> said;
    if (place == WordPlace::kWords || place == WordPlace::kAny) said = Find(capture);
    return said.value_or(std::string(capture));
  }

  std::optional<std::string> FindList(std::string_view english, std::string_view separator) {
    std::vector<std::string> parts;
    for (size_t at = 0; at <= english.size();) {
      const size_t end = std::min(english.find(separator, at), english.size());
      const auto said = Find(english.substr(at, end - at));
      if (!said) return std::nullopt;
      parts.push_back(*said);
      at = end + separator.size();
    }
    const bool chinese = language_ == Language::kChinese;
    return fmt::format("{}", fmt::join(parts, !chinese ? separator : separator == "; " ? "；" : "，"));
  }

  const WordTable& table_;
  Language language_;
  std::map<std::string, std::optional<std::string>, std::less<>> known_;
};

/// Up to each full stop that a blank follows, with the stop.
std::vector<std::string_view> Sentences(std::string_view text) {
  std::vector<std::string_view> sentences;
  for (size_t at = 0; at < text.size();) {
    const size_t stop = text.find(". ", at);
    const size_t end = stop == std::string_view::npos ? text.size() : stop + 1;
    sentences.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return sentences;
}

std::string SayLine(Language language, std::string_view line) {
  // The first word is as wide as its column, or ends at the first blank behind it.
  const size_t end = line.size() > kLabelWidth ? line.find(' ', kLabelWidth) : std::string_view::npos;
  if (end == std::string_view::npos) return Say(language, line);
  std::string label = Say(language, line.substr(0, line.find_last_not_of(' ', end - 1) + 1));
  const size_t columns = ColumnsOf(label);
  if (columns < kLabelWidth) label.append(kLabelWidth - columns, ' ');
  return label + ' ' + Say(language, line.substr(end + 1));
}

}  // namespace

Language ParseLanguage(const std::string& word) {
  std::vector<std::string> known;
  for (const auto& [name, language] : kLanguageWords) {
    if (name == word) return language;
    known.emplace_back(name);
  }
  throw InputError(SourceLocation{}, "--lang: " + UnknownName("language", word, known));
}

std::string Say(Language language, std::string_view english) {
  if (language == Language::kEnglish) return std::string(english);
  Teller teller(Words(), language);
  if (auto whole = teller.Find(english)) return *whole;
  std::string text;
  for (const std::string_view sentence : Sentences(english)) {
    const auto said = teller.Find(sentence);
    if (!text.empty() && !(language == Language::kChinese && text.ends_with("。"))) text += ' ';
    text += said ? *said : std::string(sentence);
  }
  return text;
}

bool CanSay(std::string_view english) {
  Teller teller(Words(), Language::kGerman);
  return teller.Find(english) ||
         std::ranges::all_of(Sentences(english), [&](auto one) { return teller.Find(one).has_value(); });
}

std::string SayBrief(Language language, std::string_view brief) {
  if (language == Language::kEnglish) return std::string(brief);
  std::string text;
  for (const std::string_view line : LinesOf(brief)) text += SayLine(language, line) + '\n';
  return text;
}

}  // namespace millpose
