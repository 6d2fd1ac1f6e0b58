// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_block.hpp"

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr size_t kMaxLine = 10000;  // characters; nothing sensible is longer

bool IsBlankInBlock(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool IsLetter(char c) { return (c >= 'A' && c <= 'Z') || c == '_' || c == '$'; }

std::string UpperCase(std::string_view line) {
  std::string upper(line);
  bool quoted = false;
  for (char& c : upper) {
    if (c == '"') quoted = !quoted;
    if (!quoted && c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return upper;
}

}  // namespace

void GcodeScanner::Refuse(size_t at, const std::string& why) const { throw InputError(Here(at), why); }

bool GcodeScanner::Next(GcodeBlock& block) {
  while (next_line_ < bytes_.size()) {
    const size_t end = std::min(bytes_.find('\n', next_line_), bytes_.size());
    const std::string_view line = bytes_.substr(next_line_, end - next_line_);
    next_line_ = end + 1;
    ++line_;
    if (line.size() > kMaxLine)
      Refuse(kMaxLine, fmt::format("the line is longer than {} characters", kMaxLine));
    text_ = UpperCase(line);
    block = {{}, line_, false};
    Split(block);
    if (!block.words.empty()) return true;
  }
  return false;
}

void GcodeScanner::Split(GcodeBlock& block) {
  at_ = line_ == 1 && text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  SkipBlanks();
  if (At(at_) == '/') {
    block.skippable = true;
    ++at_;
    if (IsDigit(At(at_))) ++at_;  // "/1": one of several skip levels
  }
  SkipBlanks();
  if (At(at_) == ':') {
    ++at_;
    Number();
  }
  for (SkipBlanks(); at_ < text_.size() && At(at_) != ';'; SkipBlanks()) {
    const char c = At(at_);
    if (c == '(') {
      Parentheses();  // a comment
    } else if (c == '%') {
      return TakeTapeMark(block);
    } else if (c == '*') {  // Heidenhain: the block's end
      ++at_;
      SkipBlanks();
      if (at_ < text_.size() && At(at_) != ';' && At(at_) != '(') Refuse(at_, "\"*\" ends a block");
    } else if (c == ',') {
      TakeComma(block);
    } else if (c == '#' || c == '[') {
      Refuse(at_, "parameters and expressions are not read: let the CAM system write plain numbers");
    } else if (IsLetter(c)) {
      GcodeWord word = Word();
      if (word.address != "N" && word.address != "O") block.words.push_back(std::move(word));
    } else {
      Refuse(at_, fmt::format("\"{}\" begins no word", c > ' ' && c <= '~' ? c : '?'));
    }
  }
}

// ",R5" and ",C2" round and bevel a corner; else a comma says nothing.
void GcodeScanner::TakeComma(GcodeBlock& block) {
  const size_t begin = at_++;
  SkipBlanks();
  const bool corner = At(at_) == 'R' || At(at_) == 'C' || At(at_) == 'A';
  if (!corner || IsLetter(At(at_ + 1))) return;
  GcodeWord word = Word();
  word.address.insert(0, ",");
  word.place = Here(begin);
  block.words.push_back(std::move(word));
}

// "%", "%100", "%_N_PART_MPF": nothing. "%PART G71 *" begins a program of Heidenhain's, and ends it behind
// a number.
void GcodeScanner::TakeTapeMark(GcodeBlock& block) {
  std::string_view rest = std::string_view(text_).substr(at_);
  rest = rest.substr(0, rest.find(';'));
  while (!rest.empty() && IsBlankInBlock(rest.back())) rest.remove_suffix(1);
  at_ = text_.size();
  const bool inch = rest.ends_with(" G70 *") || rest.ends_with(" G70*");
  if (!inch && !rest.ends_with(" G71 *") && !rest.ends_with(" G71*")) return;
  heidenhain_ = true;
  GcodeWord unit;
  unit.address = "G";
  unit.value = inch ? 70 : 71;
  unit.place = Here(0);
  block.words.push_back(unit);
}

void GcodeScanner::SkipBlanks() {
  while (IsBlankInBlock(At(at_))) ++at_;
}

std::string GcodeScanner::Letters() {
  const size_t begin = at_;
  while (IsLetter(At(at_))) ++at_;
  if (at_ - begin > 1)
    while (IsLetter(At(at_)) || IsDigit(At(at_))) ++at_;
  return text_.substr(begin, at_ - begin);
}

// The inside of balanced parentheses; a comment may lack its end.
std::string GcodeScanner::Parentheses() {
  const size_t begin = ++at_;
  int depth = 1;
  bool quoted = false;
  for (; at_ < text_.size(); ++at_) {
    if (At(at_) == '"') quoted = !quoted;
    if (quoted) continue;
    depth += At(at_) == '(' ? 1 : At(at_) == ')' ? -1 : 0;
    if (depth == 0) return text_.substr(begin, at_++ - begin);
  }
  return text_.substr(begin);
}

bool GcodeScanner::StartsNumber(size_t at) const {
  if (At(at) == '+' || At(at) == '-') ++at;
  if (At(at) == '.') ++at;
  return IsDigit(At(at));
}

double GcodeScanner::Number() {
  SkipBlanks();
  const size_t begin = at_;
  if (At(at_) == '+' || At(at_) == '-') ++at_;
  while (IsDigit(At(at_)) || At(at_) == '.') ++at_;
  std::string digits = text_.substr(begin, at_ - begin);
  if (digits.starts_with('+')) digits.erase(0, 1);
  const auto value = ParseNumber(digits);
  if (At(at_) == 'E' && (IsDigit(At(at_ + 1)) || At(at_ + 1) == '-' || At(at_ + 1) == '+'))
    Refuse(at_, "exponents are not read: let the CAM system write plain numbers");
  if (!value) Refuse(begin, fmt::format("expected a number, found \"{}\"", text_.substr(begin, 20)));
  return *value;
}

GcodeWord GcodeScanner::Word() {
  GcodeWord word;
  word.place = Here(at_);
  const size_t begin = at_;
  word.address = Letters();
  if (word.address.size() == 1) {
    // "A3=0.5" has an address of two characters, "A3" a value.
    size_t end = at_;
    while (IsDigit(At(end))) ++end;
    size_t equals = end;
    while (IsBlankInBlock(At(equals))) ++equals;
    if (end > at_ && At(equals) == '=') {
      word.address += text_.substr(at_, end - at_);
      at_ = end;
    } else {
      SkipBlanks();
      if (At(at_) == '#' || At(at_) == '[')
        Refuse(at_, "parameters and expressions are not read: let the CAM system write plain numbers");
      if (At(at_) != '=') {
        if (!StartsNumber(at_)) Refuse(begin, fmt::format("{} needs a number", word.address));
        word.value = Number();
        return word;
      }
    }
  }
  if (At(at_) == '[') {  // an index: a name of its own
    const size_t close = text_.find(']', at_);
    if (close == std::string::npos) Refuse(at_, "\"]\" is missing");
    word.address += text_.substr(at_, close + 1 - at_);
    at_ = close + 1;
  }
  const size_t after = at_;
  SkipBlanks();
  if (At(at_) == '=') {
    ++at_;
    Value(word);
  } else if (At(after) == '(') {
    word.kind = GcodeWord::Kind::kCall;
    word.text = Parentheses();
  } else {
    word.kind = GcodeWord::Kind::kName;
  }
  return word;
}

// AC(…), IC(…) and the ways of rotary axes.
bool GcodeScanner::TakeWrapped(GcodeWord& word) {
  for (const auto& [name, kind] :
       {std::pair("AC(", GcodeWord::Kind::kAbsolute), std::pair("IC(", GcodeWord::Kind::kIncremental),
        std::pair("DC(", GcodeWord::Kind::kAbsolute), std::pair("ACP(", GcodeWord::Kind::kAbsolute),
        std::pair("ACN(", GcodeWord::Kind::kAbsolute)}) {
    if (!std::string_view(text_).substr(at_).starts_with(name)) continue;
    at_ += std::string_view(name).size();
    word.kind = kind;
    word.value = Number();
    SkipBlanks();
    if (At(at_) != ')') Refuse(at_, "only a number may stand in the parentheses");
    ++at_;
    return true;
  }
  return false;
}

void GcodeScanner::Value(GcodeWord& word) {
  SkipBlanks();
  const size_t begin = at_;
  if (At(at_) == '"' || At(at_) == '\'') {
    const size_t end = text_.find(At(at_), at_ + 1);
    if (end == std::string::npos) Refuse(at_, "the text has no end");
    word.kind = GcodeWord::Kind::kText;
    word.text = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
  } else if (StartsNumber(at_)) {
    word.value = Number();
  } else if (!TakeWrapped(word)) {
    word.negative = At(at_) == '-';
    if (word.negative) ++at_;
    if (!IsLetter(At(at_))) Refuse(begin, fmt::format("{} needs a value", word.address));
    word.kind = GcodeWord::Kind::kVariable;
    word.text = Letters();
    while (IsDigit(At(at_))) word.text += text_[at_++];  // R12
  }
  SkipBlanks();
  const char c = At(at_);
  size_t behind = at_ + 1;
  while (IsBlankInBlock(At(behind))) ++behind;
  if (c == '*' && behind >= text_.size()) return;  // Heidenhain: the block's end
  if (c == '*' || c == '+' || c == '-' || c == '/' || c == '(' || c == '[' || c == '<' || c == '>' ||
      c == '=')
    Refuse(begin,
           fmt::format("{}: expressions are not read: let the CAM system write plain numbers", word.address));
}

}  // namespace millpose
