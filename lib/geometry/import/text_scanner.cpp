// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/text_scanner.hpp"

#include <charconv>

#include "base/shown.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool IsLineEnd(char c) { return c == '\n' || c == '\r'; }
char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

bool EqualsIgnoringCase(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return Lower(x) == Lower(y); });
}

TextScanner::TextScanner(std::string_view bytes, std::string name, char comment)
    : bytes_(bytes), name_(std::move(name)), comment_(comment) {
  last_ = {name_, 1, 1};
}

void TextScanner::TakeLineEnd() {
  at_ += bytes_[at_] == '\r' && at_ + 1 < bytes_.size() && bytes_[at_ + 1] == '\n' ? 2 : 1;
  ++line_;
  line_start_ = at_;
}

void TextScanner::SkipSpace() {
  while (at_ < bytes_.size()) {
    const char c = bytes_[at_];
    if (IsLineEnd(c)) {
      TakeLineEnd();
    } else if (comment_ != 0 && c == comment_) {
      while (at_ < bytes_.size() && !IsLineEnd(bytes_[at_])) ++at_;
    } else if (IsBlank(c)) {
      ++at_;
    } else {
      return;
    }
  }
}

std::string_view TextScanner::Peek() {
  SkipSpace();
  last_.line = line_;
  last_.column = static_cast<int>(at_ - line_start_) + 1;
  size_t end = at_;
  while (end < bytes_.size() && !IsBlank(bytes_[end]) && !IsLineEnd(bytes_[end])) ++end;
  return bytes_.substr(at_, end - at_);
}

std::string_view TextScanner::Next() {
  const std::string_view word = Peek();
  at_ += word.size();
  return word;
}

bool TextScanner::Accept(std::string_view word) {
  if (!EqualsIgnoringCase(Peek(), word)) return false;
  Next();
  return true;
}

std::string Quoted(std::string_view word) {
  return word.empty() ? "the end of the file" : '"' + Shown(word) + '"';
}

void TextScanner::Expect(std::string_view word) {
  const std::string_view found = Next();
  if (!EqualsIgnoringCase(found, word))
    throw InputError(place(), fmt::format("expected \"{}\", found {}", word, Quoted(found)));
}

double TextScanner::Number() {
  const std::string_view word = Next();
  const std::optional<double> value = ParseNumber(word);
  if (!value) throw InputError(place(), fmt::format("expected a finite number, found {}", Quoted(word)));
  return *value;
}

long long TextScanner::Integer(long long lower, long long upper, std::string_view what) {
  const std::string_view word = Next();
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size() || value < lower ||
      value > upper)
    throw InputError(place(), fmt::format("{} must be a whole number from {} to {}, found {}", what, lower,
                                          upper, Quoted(word)));
  return value;
}

std::string_view TextScanner::Line() {
  size_t end = at_;
  while (end < bytes_.size() && !IsLineEnd(bytes_[end])) ++end;
  const std::string_view rest = bytes_.substr(at_, end - at_);
  last_.line = line_;
  last_.column = static_cast<int>(at_ - line_start_) + 1;
  at_ = end;
  if (at_ < bytes_.size()) TakeLineEnd();
  return rest;
}

void TextScanner::SkipLine() { Line(); }

bool TextScanner::MoreInLine() {
  for (; at_ < bytes_.size(); ++at_) {
    if (bytes_[at_] == '\\' && at_ + 1 < bytes_.size() && IsLineEnd(bytes_[at_ + 1])) {
      ++at_;
      TakeLineEnd();
      --at_;  // the loop goes on with the first character of the joined line
    } else if (!IsBlank(bytes_[at_])) {
      break;
    }
  }
  return at_ < bytes_.size() && !IsLineEnd(bytes_[at_]) && (comment_ == 0 || bytes_[at_] != comment_);
}

SourceLocation TextScanner::place() const { return last_; }

}  // namespace millpose
