// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// One word of a G-code block: an address with a value ("X12.5", "A3=0.5", "I=AC(3)"), or a name.
struct GcodeWord {
  enum class Kind : uint8_t {
    kValue,        ///< address and number
    kAbsolute,     ///< AC(), DC(), ACP(), ACN(): absolute whatever G90 and G91 say
    kIncremental,  ///< IC()
    kVariable,     ///< address = name of a variable, kept in `text`
    kText,         ///< address = "text"
    kName,         ///< a name alone: TRAORI
    kCall,         ///< a name with parentheses, their inside in `text`: CYCLE832(0.02,1,1)
  };
  Kind kind = Kind::kValue;
  std::string address;  ///< upper case: "X", "A3", "CR", "TRAORI"
  double value = 0;
  bool negative = false;  ///< of a variable: -_NAME
  std::string text;
  SourceLocation place;
};

/// The words of one line. Line numbers, program numbers, comments and `%` lines are gone.
struct GcodeBlock {
  std::vector<GcodeWord> words;
  int line = 0;
  bool skippable = false;  ///< begins with "/"
};

/// Splits ISO and SINUMERIK 840D programs into blocks. Throws InputError with line and column for
/// parameters (#1), expressions and what belongs to no word.
class GcodeScanner {
 public:
  GcodeScanner(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  /// False at the end. Blocks without words are passed over.
  bool Next(GcodeBlock& block);
  /// The head is "%NAME G71 *": Heidenhain's DIN/ISO, whose blocks end with "*".
  bool heidenhain() const { return heidenhain_; }

 private:
  void Split(GcodeBlock& block);
  void TakeTapeMark(GcodeBlock& block);
  void TakeComma(GcodeBlock& block);
  GcodeWord Word();
  void Value(GcodeWord& word);
  bool TakeWrapped(GcodeWord& word);
  std::string Letters();
  std::string Parentheses();
  double Number();
  bool StartsNumber(size_t at) const;
  char At(size_t at) const { return at < text_.size() ? text_[at] : '\0'; }
  void SkipBlanks();
  SourceLocation Here(size_t at) const { return {name_, line_, static_cast<int>(at) + 1}; }
  [[noreturn]] void Refuse(size_t at, const std::string& why) const;

  std::string_view bytes_;
  std::string name_;
  size_t next_line_ = 0;
  int line_ = 0;
  std::string text_;  // the line, upper case outside of quotes
  size_t at_ = 0;
  bool heidenhain_ = false;
};

}  // namespace millpose
