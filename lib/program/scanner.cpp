// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/scanner.hpp"

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr double kLargestNumber = 1e9;  // no length, angle, feed or speed of a robot's program reaches it

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r'; }
char Upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

}  // namespace

bool IsWordCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '$';
}

std::vector<std::string_view> SplitLines(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return lines;
}

std::string_view Trim(std::string_view text) {
  while (!text.empty() && IsSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsSpace(text.back())) text.remove_suffix(1);
  return text;
}

bool SameWords(std::string_view a, std::string_view b) {
  a = Trim(a);
  b = Trim(b);
  while (!a.empty() && !b.empty()) {
    if (IsSpace(a.front()) != IsSpace(b.front()) || Upper(a.front()) != Upper(b.front())) {
      if (!(IsSpace(a.front()) && IsSpace(b.front()))) return false;
    }
    const bool space = IsSpace(a.front());
    a.remove_prefix(1);
    b.remove_prefix(1);
    if (space) {
      a = Trim(a);
      b = Trim(b);
    }
  }
  return a.empty() && b.empty();
}

void LineScanner::SkipSpace() {
  while (position_ < line_.size() && IsSpace(line_[position_])) ++position_;
}

std::string Spelled(std::string_view text) {
  std::string spelled;
  bool blank = false;
  for (const char c : Trim(text)) {
    const bool white = c == ' ' || c == '\t';
    if (!white) {
      if (blank && IsWordCharacter(spelled.back()) && IsWordCharacter(c)) spelled += ' ';
      spelled += Upper(c);
    }
    blank = white;
  }
  return spelled;
}

bool LineScanner::AtEnd() { return Peek() == '\0'; }

char LineScanner::Peek() {
  SkipSpace();
  return position_ < line_.size() ? line_[position_] : '\0';
}

bool LineScanner::Accept(std::string_view word) {
  SkipSpace();
  size_t end = position_;
  for (const char c : word) {
    if (end >= line_.size()) return false;
    if (c == ' ') {  // any amount of white space
      if (!IsSpace(line_[end])) return false;
      while (end < line_.size() && IsSpace(line_[end])) ++end;
    } else if (Upper(line_[end++]) != Upper(c)) {
      return false;
    }
  }
  if (IsWordCharacter(word.back()) && end < line_.size() && IsWordCharacter(line_[end])) return false;
  position_ = end;
  return true;
}

void LineScanner::Expect(std::string_view word) {
  if (!Accept(word)) Fail(fmt::format("'{}' expected", word));
}

void LineScanner::ExpectEnd() {
  if (!AtEnd()) Fail("the end of the statement expected");
}

bool LineScanner::AcceptAddress(char letter, bool blanks) {
  SkipSpace();
  if (position_ >= line_.size() || Upper(line_[position_]) != letter) return false;
  size_t next = position_ + 1;
  while (blanks && next < line_.size() && IsSpace(line_[next])) ++next;
  if (next >= line_.size() ||
      std::string_view("0123456789+-.=").find(line_[next]) == std::string_view::npos) {
    return false;
  }
  ++position_;
  return true;
}

double LineScanner::ExpectNumber() {
  SkipSpace();
  const auto is_digit = [&](size_t i) { return i < line_.size() && line_[i] >= '0' && line_[i] <= '9'; };
  const auto is_sign = [&](size_t i) { return i < line_.size() && (line_[i] == '+' || line_[i] == '-'); };
  size_t end = position_ + (is_sign(position_) ? 1 : 0);
  while (is_digit(end) || (end < line_.size() && line_[end] == '.')) ++end;
  if (end < line_.size() && Upper(line_[end]) == 'E') {
    const size_t exponent = end + (is_sign(end + 1) ? 2 : 1);
    if (is_digit(exponent)) {
      for (end = exponent; is_digit(end);) ++end;
    }
  }
  const std::optional<double> value = ParseNumber(line_.substr(position_, end - position_));
  if (!value) Fail("a decimal number expected");
  if (std::abs(*value) > kLargestNumber) Fail("a number that a program may hold (up to 1e9) expected");
  position_ = end;
  return *value;
}

double LineScanner::ExpectDecimal(bool blanks) {
  SkipSpace();
  std::string digits;
  size_t end = position_;
  for (size_t i = position_; i < line_.size(); ++i) {
    if (blanks && IsSpace(line_[i])) continue;
    const bool sign = digits.empty() && (line_[i] == '+' || line_[i] == '-');
    if (!sign && line_[i] != '.' && (line_[i] < '0' || line_[i] > '9')) break;
    digits += line_[i];
    end = i + 1;
  }
  const std::optional<double> value = ParseNumber(digits);
  if (!value) Fail("a decimal number without an exponent expected");
  position_ = end;
  return *value;
}

int LineScanner::ExpectBits() {
  SkipSpace();
  const size_t end = line_.find('\'', std::min(position_ + 1, line_.size()));
  const std::string_view digits =
      line_.substr(position_, end == std::string_view::npos ? 0 : end - position_);
  if (digits.size() < 3 || digits.size() > 10 || Upper(digits[1]) != 'B' ||
      digits.substr(2).find_first_not_of("01") != std::string_view::npos) {
    Fail("bits such as 'B010' expected");
  }
  int bits = 0;
  for (const char digit : digits.substr(2)) bits = bits * 2 + (digit - '0');
  position_ = end + 1;
  return bits;
}

std::optional<std::string> LineScanner::AcceptName() {
  SkipSpace();
  size_t end = position_;
  while (end < line_.size() && IsWordCharacter(line_[end])) ++end;
  if (end == position_ || (line_[position_] >= '0' && line_[position_] <= '9')) return std::nullopt;
  std::string name(line_.substr(position_, end - position_));
  position_ = end;
  return name;
}

std::string LineScanner::Rest() {
  std::string rest(Trim(line_.substr(position_)));
  position_ = line_.size();
  return rest;
}

std::string LineScanner::TakeUntil(char end) {
  const size_t stop = std::min(line_.find(end, position_), line_.size());
  std::string taken(line_.substr(position_, stop - position_));
  position_ = stop;
  return taken;
}

size_t LineScanner::Next() {
  SkipSpace();
  return position_;
}

SourceLocation LineScanner::PlaceOf(size_t start) const {
  return {file_, number_, static_cast<int>(start) + 1, -1};
}

std::string LineScanner::TakenFrom(size_t start) const {
  return std::string(Trim(line_.substr(start, position_ - start)));
}

void LineScanner::FailFrom(size_t start, const std::string& message) const {
  throw InputError(PlaceOf(start), fmt::format("{}, but '{}' given", message, TakenFrom(start)));
}

int LineScanner::WholeFrom(size_t start, double number, int least, int most) const {
  if (number < least || number > most || number != std::floor(number))
    FailFrom(start, fmt::format("a whole number {} to {} expected", least, most));
  return static_cast<int>(number);
}

void LineScanner::Fail(const std::string& message) const {
  const std::string given(Trim(line_.substr(std::min(position_, line_.size()))));
  throw InputError(
      SourceLocation{file_, number_, static_cast<int>(position_) + 1, -1},
      given.empty() ? message + ", but the line ends" : fmt::format("{}, but '{}' given", message, given));
}

}  // namespace millpose
