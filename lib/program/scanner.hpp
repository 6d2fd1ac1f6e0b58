// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a program text line by line, with the place of whatever is wrong.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// The lines of a text without their ends; LF, CRLF, a last line without an end.
std::vector<std::string_view> SplitLines(std::string_view text);

/// `text` without the white space at both ends.
std::string_view Trim(std::string_view text);

/// A letter (ASCII), digit, '_' or '$'.
bool IsWordCharacter(char c);

/// Equal apart from case (ASCII) and the amount of white space.
bool SameWords(std::string_view a, std::string_view b);

/// In upper case (ASCII), with white space only between words, and single there: equal for all that look
/// alike.
std::string Spelled(std::string_view text);

/// A cursor over one line. Words compare without case (ASCII). Expectations that fail throw InputError with
/// file:line:column.
class LineScanner {
 public:
  LineScanner(std::string_view line, std::string file, int number)
      : line_(line), file_(std::move(file)), number_(number) {}

  bool AtEnd();  ///< nothing but white space follows
  char Peek();   ///< the next character that is not white space; '\0' at the end
  /// Takes `word` when it comes next (after white space); a word that ends in a letter, digit or '_' must not
  /// be followed by another of them.
  bool Accept(std::string_view word);
  void Expect(std::string_view word);
  void ExpectEnd();
  /// Takes `letter` when it comes next and begins an address: a digit, sign, point or '=' follows (after
  /// spaces, where `blanks`).
  bool AcceptAddress(char letter, bool blanks = true);
  void Skip() { ++position_; }  ///< over one character
  double ExpectNumber();        ///< decimal; a comma as decimal mark is an error
  /// Digits with at most one point and one sign, no exponent. `blanks`: may stand between them and count for
  /// nothing (RS-274).
  double ExpectDecimal(bool blanks = false);
  int ExpectBits();                         ///< 'B0101'
  std::optional<std::string> AcceptName();  ///< letters, digits, '_', '$'; upper case as written
  std::string Rest();                       ///< takes what is left, trimmed
  std::string TakeUntil(char end);          ///< takes what stands before `end`, or before the line's end
  /// Where the next word begins, for FailFrom().
  size_t Next();
  /// What comes next is wrong.
  [[noreturn]] void Fail(const std::string& message) const;
  /// What was taken from `start` (Next() before) on is wrong.
  [[noreturn]] void FailFrom(size_t start, const std::string& message) const;
  /// `number`, which was read from `start` (Next() before) on: whole and within these bounds.
  int WholeFrom(size_t start, double number, int least, int most) const;
  int number() const { return number_; }
  /// The place of column `start` (Next() before), and what was taken from there on.
  SourceLocation PlaceOf(size_t start) const;
  std::string TakenFrom(size_t start) const;

 private:
  void SkipSpace();

  std::string_view line_;
  std::string file_;
  int number_;
  size_t position_ = 0;
};

}  // namespace millpose
