// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_scanner.hpp"

#include <optional>

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr size_t kDataColumns = 72;
constexpr size_t kMaxStatement = 100000;  // characters; nothing sensible is longer

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

std::string_view WithoutTrailingBlanks(std::string_view text) {
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

// Creo's remarks begin with "$$->" and go on like statements: the rows of a matrix.
bool IsCreoComment(std::string_view line) {
  while (!line.empty() && IsBlank(line.front())) line.remove_prefix(1);
  return line.starts_with("$$->");
}

void AppendUpper(std::string_view line, std::string& text) {
  for (const char c : line) text += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

bool IsDigits(std::string_view text) {
  return text.find_first_not_of("0123456789 ") == std::string_view::npos &&
         text.find_first_of("0123456789") != std::string_view::npos;
}

// A statement's characters with their places.
struct Text {
  std::string characters;
  std::vector<std::pair<int, int>> places;
};

AptWord Word(const Text& text, size_t begin, size_t end, const std::string& name) {
  while (begin < end && IsBlank(text.characters[begin])) ++begin;
  while (end > begin && IsBlank(text.characters[end - 1])) --end;
  AptWord word{text.characters.substr(begin, end - begin), {name}};
  if (!text.places.empty()) {
    const auto& [line, column] = text.places[std::min(begin, text.places.size() - 1)];
    word.place.line = line;
    word.place.column = column;
  }
  return word;
}

}  // namespace

std::string_view AptScanner::TakeLine() {
  size_t end = at_;
  while (end < bytes_.size() && bytes_[end] != '\n' && bytes_[end] != '\r') ++end;
  const std::string_view line = bytes_.substr(at_, end - at_);
  at_ = std::min(bytes_.size(), end + 1);
  if (end + 1 < bytes_.size() && bytes_[end] == '\r' && bytes_[end + 1] == '\n') ++at_;
  ++line_;
  return line;
}

// Columns 73 to 80 of a card hold its number. A long line without cards looks alike where its last number
// reaches over column 72: there is a number only behind a blank or a "$", and none behind an open comma.
std::string_view AptScanner::WithoutSequenceNumber(std::string_view line) {
  if (line.size() <= kDataColumns || line.size() > 80 || !IsDigits(line.substr(kDataColumns))) return line;
  const char last = line[kDataColumns - 1];
  const std::string_view data = WithoutTrailingBlanks(line.substr(0, kDataColumns));
  if ((last == ' ' || last == '$') && !data.ends_with(',')) {
    cards_ = true;
    return line.substr(0, kDataColumns);
  }
  if (cards_ && line.size() == 80)
    throw InputError({name_, line_, static_cast<int>(kDataColumns) + 1},
                     "columns 73 to 80 may be the card's number or belong to the data before them");
  return line;
}

// Keeps a line that is a comment as a whole, Creo's with the lines that it goes on over; false for others.
bool AptScanner::TakeComment(std::string_view line) {
  const size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos || !line.substr(first).starts_with("$$")) return false;
  AptWord comment{"", {name_, line_, static_cast<int>(first) + 1}};
  const bool creo = IsCreoComment(line);
  for (line.remove_prefix(first);;) {
    line = WithoutTrailingBlanks(line);
    const bool goes_on = creo && line.ends_with('$') && at_ < bytes_.size();
    if (goes_on) line.remove_suffix(1);
    AppendUpper(line, comment.text);
    if (comment.text.size() > kMaxStatement)
      throw InputError({name_, line_}, fmt::format("a comment is longer than {} characters", kMaxStatement));
    if (!goes_on) break;
    comment.text += ' ';
    line = TakeLine();
  }
  comments_.push_back(std::move(comment));
  return true;
}

bool AptScanner::Next(AptStatement& statement) {
  Text text;
  comments_.clear();
  for (bool goes_on = true; goes_on || WithoutTrailingBlanks(text.characters).empty();) {
    if (at_ >= bytes_.size()) {
      if (WithoutTrailingBlanks(text.characters).empty()) return false;
      break;
    }
    std::string_view line = WithoutSequenceNumber(TakeLine());
    if (TakeComment(line)) continue;
    line = WithoutTrailingBlanks(line.substr(0, line.find("$$")));
    goes_on = line.ends_with('$');
    if (goes_on) line.remove_suffix(1);
    for (size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      text.characters += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      text.places.emplace_back(line_, static_cast<int>(i) + 1);
    }
    if (text.characters.size() > kMaxStatement)
      throw InputError({name_, line_},
                       fmt::format("a statement is longer than {} characters", kMaxStatement));
  }
  const size_t slash = text.characters.find('/');
  statement.major = Word(text, 0, std::min(slash, text.characters.size()), name_);
  statement.minors.clear();
  for (size_t begin = slash; begin != std::string::npos && begin < text.characters.size();) {
    const size_t end = std::min(text.characters.find(',', begin + 1), text.characters.size());
    statement.minors.push_back(Word(text, begin + 1, end, name_));
    begin = end;
  }
  return true;
}

std::vector<double> Numbers(const AptStatement& statement, size_t least, size_t most) {
  std::vector<double> numbers;
  for (const AptWord& word : statement.minors) {
    const std::optional<double> number = ParseNumber(word.text);
    if (!number)
      throw InputError(word.place, fmt::format("{} needs numbers, found \"{}\"", statement.major.text,
                                               word.text.substr(0, 40)));
    numbers.push_back(*number);
  }
  if (numbers.size() < least || numbers.size() > most)
    throw InputError(statement.major.place, fmt::format("{} needs {} to {} numbers, found {}",
                                                        statement.major.text, least, most, numbers.size()));
  return numbers;
}

}  // namespace millpose
