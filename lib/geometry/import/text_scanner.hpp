// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "base/error.hpp"

namespace millpose {

/// Equality of ASCII texts, letters compared without case.
bool EqualsIgnoringCase(std::string_view a, std::string_view b);

/// A word as messages quote it (base/shown.hpp); an empty one is the end of the file.
std::string Quoted(std::string_view word);

/// Words of a text, one after the other, with their place. Spaces, tabs and line ends of any kind (LF, CRLF,
/// CR) separate words. Errors are InputError with line and column.
class TextScanner {
 public:
  /// `bytes` must outlive the scanner; `name` is for messages; `comment` 0 means that there are no comments.
  TextScanner(std::string_view bytes, std::string name, char comment = 0);

  /// True when no word is left.
  bool AtEnd() { return Peek().empty(); }
  /// The next word without taking it; empty at the end.
  std::string_view Peek();
  /// Takes the next word; empty at the end.
  std::string_view Next();
  /// Takes the next word if it is `word` (without case).
  bool Accept(std::string_view word);
  /// Takes the next word, which must be `word` (without case).
  void Expect(std::string_view word);
  /// Takes the next word, which must be a finite decimal number.
  double Number();
  /// Takes the next word, which must be an integer in lower..upper; `what` names it in the error.
  long long Integer(long long lower, long long upper, std::string_view what);
  /// Skips the rest of the line that the scanner stands in.
  void SkipLine();
  /// The rest of the line that the scanner stands in, without its end; moves to the next line.
  std::string_view Line();
  /// True when a word is left before the end of this line; a backslash at its end joins the next line to it.
  bool MoreInLine();
  /// Byte at which the scanner stands.
  size_t position() const { return at_; }
  /// Line in which it stands.
  int line() const { return line_; }
  /// Place of the word that was peeked at or taken last.
  SourceLocation place() const;

 private:
  void SkipSpace();
  void TakeLineEnd();

  std::string_view bytes_;
  std::string name_;
  char comment_;
  size_t at_ = 0;
  int line_ = 1;
  size_t line_start_ = 0;
  SourceLocation last_;
};

}  // namespace millpose
