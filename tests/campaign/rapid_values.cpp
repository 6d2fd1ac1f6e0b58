// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/rapid_values.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>

namespace millpose::campaign {
namespace {

using TokenKind = RapidToken::Kind;

bool IsDecimal(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool IsAlpha(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Cuts one line into tokens.
class Lexer {
 public:
  Lexer(const std::string& line, int number) : line_(line), number_(number) {}

  void Cut(std::deque<RapidToken>& tokens) {
    bool first = true;
    for (; at_ < line_.size(); first = false) {
      const char c = line_[at_];
      if (c == ' ' || c == '\t' || c == '\r') {
        ++at_;
      } else if (c == '!') {  // "Comments": to the end of the line
        if (first || line_.find_first_not_of(" \t") == at_)
          tokens.push_back({TokenKind::kComment, line_.substr(at_ + 1), 0, number_});
        return;
      } else if (c == '"') {
        tokens.push_back(StringToken());
      } else if (IsDecimal(c) || (c == '.' && at_ + 1 < line_.size() && IsDecimal(line_[at_ + 1]))) {
        tokens.push_back(NumberToken());
      } else if (IsAlpha(c)) {  // "Identifiers": a letter first
        const size_t begin = at_;
        while (at_ < line_.size() && (IsAlpha(line_[at_]) || IsDecimal(line_[at_]) || line_[at_] == '_'))
          ++at_;
        tokens.push_back({TokenKind::kWord, Upper(line_.substr(begin, at_ - begin)), 0, number_});
      } else {
        const bool assigns = line_.compare(at_, 2, ":=") == 0;
        static const std::string signs = "[](),;:\\%*/+-=<>.{}";
        if (signs.find(c) == std::string::npos) throw Refusal{fmt::format("no sign of the language: {}", c)};
        tokens.push_back({TokenKind::kSign, line_.substr(at_, assigns ? 2 : 1), 0, number_});
        at_ += assigns ? 2 : 1;
      }
    }
  }

 private:
  RapidToken StringToken() {
    const size_t end = line_.find('"', at_ + 1);
    if (end == std::string::npos) throw Refusal{"a text without its end"};
    RapidToken token{TokenKind::kString, line_.substr(at_ + 1, end - at_ - 1), 0, number_};
    if (token.text.size() > 80) throw Refusal{"a text of more than 80 characters"};
    at_ = end + 1;
    return token;
  }

  RapidToken NumberToken() {
    const size_t begin = at_;
    while (at_ < line_.size() && IsDecimal(line_[at_])) ++at_;
    if (at_ < line_.size() && line_[at_] == '.')
      for (++at_; at_ < line_.size() && IsDecimal(line_[at_]);) ++at_;
    if (at_ < line_.size() && (line_[at_] == 'E' || line_[at_] == 'e')) {
      size_t next = at_ + 1;
      if (next < line_.size() && (line_[next] == '-' || line_[next] == '+')) ++next;
      if (next >= line_.size() || !IsDecimal(line_[next])) throw Refusal{"an exponent expected"};
      for (at_ = next; at_ < line_.size() && IsDecimal(line_[at_]);) ++at_;
    }
    if (at_ < line_.size() && (IsAlpha(line_[at_]) || line_[at_] == '_' || line_[at_] == '.'))
      throw Refusal{"a number ends in a letter"};
    const std::string text = line_.substr(begin, at_ - begin);
    const double value = std::strtod(text.c_str(), nullptr);
    if (!(value < 3.4e38)) throw Refusal{"a number that num does not hold"};
    return {TokenKind::kNumber, text, static_cast<double>(static_cast<float>(value)), number_};
  }

  const std::string& line_;
  const int number_;
  size_t at_ = 0;
};

std::vector<double> Numbers(RapidArguments& in, size_t count) {
  std::vector<double> numbers;
  in.Need("[");
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) in.Need(",");
    numbers.push_back(in.Num());
  }
  in.Need("]");
  return numbers;
}

/// "orient": must be normalised.
Eigen::Matrix3d Orient(RapidArguments& in) {
  const std::vector<double> q = Numbers(in, 4);
  Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  if (std::abs(turn.norm() - 1) > 1e-5) throw Refusal{"a quaternion that is not normalised"};
  turn.normalize();
  return turn.toRotationMatrix();
}

Pose PoseAggregateOf(RapidArguments& in) {
  in.Need("[");
  const std::vector<double> p = Numbers(in, 3);
  in.Need(",");
  const Eigen::Matrix3d R = Orient(in);
  in.Need("]");
  return Frame(p[0], p[1], p[2], R);
}

void Tool(RapidArguments& in, RapidValue& value) {
  if (!in.Truth()) throw Refusal{"a tool that does not move"};
  in.Need(",");
  value.frame = PoseAggregateOf(in);
  in.Need(",");
  in.Need("[");
  value.numbers = {in.Num()};
  if (!(value.numbers[0] > 0)) throw Refusal{"a tool without mass"};
  in.Need(",");
  for (const double part : Numbers(in, 3)) value.numbers.push_back(part);
  in.Need(",");
  const Eigen::Quaterniond axes(Orient(in));
  for (const double part : {axes.x(), axes.y(), axes.z()}) value.numbers.push_back(part);
  for (int i = 0; i < 3; ++i) {
    in.Need(",");
    value.numbers.push_back(in.Num());
  }
  in.Need("]");
}

void Object(RapidArguments& in, RapidValue& value) {
  if (in.Truth()) throw Refusal{"the robot holds the part"};
  in.Need(",");
  const bool fixed = in.Truth();
  in.Need(",");
  value.unit = Upper(in.String());
  if (fixed == !value.unit.empty()) throw Refusal{"ufprog and ufmec say different things"};
  in.Need(",");
  value.user = PoseAggregateOf(in);
  in.Need(",");
  value.frame = PoseAggregateOf(in);
}

}  // namespace

RapidStream::RapidStream(const std::string& text) {
  int number = 0;
  for (const std::string& line : LinesOf(text)) Lexer(line, ++number).Cut(tokens_);
}

void RapidStream::SkipComments() {
  while (!tokens_.empty() && tokens_.front().kind == TokenKind::kComment) tokens_.pop_front();
}

bool RapidStream::Take(const std::string& text) {
  SkipComments();
  if (tokens_.empty() || tokens_.front().kind == TokenKind::kString || tokens_.front().text != text)
    return false;
  tokens_.pop_front();
  return true;
}

void RapidStream::Need(const std::string& text) {
  if (!Take(text)) throw Refusal{text + " expected"};
}

std::string RapidStream::Identifier() {
  SkipComments();
  if (tokens_.empty() || tokens_.front().kind != TokenKind::kWord) throw Refusal{"an identifier expected"};
  const std::string name = tokens_.front().text;
  tokens_.pop_front();
  if (name.size() > 32) throw Refusal{"an identifier of more than 32 characters"};
  return name;
}

std::string RapidStream::Comment() {
  if (tokens_.empty() || tokens_.front().kind != TokenKind::kComment) return {};
  const std::string text = "!" + tokens_.front().text;
  tokens_.pop_front();
  return text;
}

std::vector<RapidToken> RapidStream::Until(const std::string& end) {
  std::vector<RapidToken> tokens;
  while (!tokens_.empty()) {
    const RapidToken token = tokens_.front();
    tokens_.pop_front();
    if (token.kind == TokenKind::kComment) continue;
    if (token.kind == TokenKind::kSign && token.text == end) return tokens;
    tokens.push_back(token);
  }
  throw Refusal{end + " is missing"};
}

bool RapidArguments::Sees(const std::string& text) const {
  return at_ < tokens_.size() && tokens_[at_].kind != TokenKind::kString && tokens_[at_].text == text;
}

bool RapidArguments::Take(const std::string& text) {
  if (!Sees(text)) return false;
  ++at_;
  return true;
}

void RapidArguments::Need(const std::string& text) {
  if (!Take(text)) throw Refusal{text + " expected"};
}

std::string RapidArguments::Identifier() {
  if (at_ >= tokens_.size() || tokens_[at_].kind != TokenKind::kWord) throw Refusal{"a name expected"};
  return tokens_[at_++].text;
}

std::string RapidArguments::String() {
  if (at_ >= tokens_.size() || tokens_[at_].kind != TokenKind::kString) throw Refusal{"a text expected"};
  return tokens_[at_++].text;
}

double RapidArguments::Num() {
  const bool negative = Take("-");
  if (!negative) Take("+");
  if (at_ >= tokens_.size() || tokens_[at_].kind != TokenKind::kNumber) throw Refusal{"a number expected"};
  const double value = tokens_[at_++].value;
  return negative ? -value : value;
}

bool RapidArguments::Truth() {
  const bool truth = Take("TRUE");
  if (!truth) Need("FALSE");
  return truth;
}

void RapidArguments::End() const {
  if (at_ != tokens_.size()) throw Refusal{"; expected"};
}

std::string RapidArguments::Switches() {
  std::string text;
  while (Sees("\\")) {
    while (at_ < tokens_.size() && !Sees(",")) text += tokens_[at_++].text;
  }
  return text;
}

std::string RapidArguments::Text(const std::string& word) {
  std::string text = word;
  bool before = !word.empty();
  for (; at_ < tokens_.size(); ++at_) {
    const RapidToken& token = tokens_[at_];
    const bool now = token.kind == TokenKind::kWord || token.kind == TokenKind::kNumber;
    if (before && now) text += " ";
    text += token.kind == TokenKind::kNumber ? fmt::format("{}", token.value) : token.text;
    before = now;
  }
  return text;
}

RapidValue ReadRapidValue(const std::string& type, RapidArguments& in) {
  RapidValue value;
  value.type = type;
  if (type == "SPEEDDATA") {
    value.numbers = Numbers(in, 4);
    for (const double speed : value.numbers)
      if (!(speed > 0)) throw Refusal{"a speed above 0 expected"};
    return value;
  }
  in.Need("[");
  if (type == "TOOLDATA") {
    Tool(in, value);
  } else if (type == "WOBJDATA") {
    Object(in, value);
  } else if (type == "ZONEDATA") {  // "zonedata": orientation and axes never have a smaller zone than the tip
    value.fine = in.Truth();
    for (int i = 0; i < 6; ++i) {
      in.Need(",");
      value.numbers.push_back(in.Num());
      if (value.numbers.back() < 0) throw Refusal{"a zone of 0 or more expected"};
    }
  } else if (type == "JOINTTARGET") {
    value.numbers = Numbers(in, 6);
    in.Need(",");
    value.eax = Numbers(in, 6);
  } else if (type == "ROBTARGET") {
    const std::vector<double> p = Numbers(in, 3);
    in.Need(",");
    value.frame = Frame(p[0], p[1], p[2], Orient(in));
    in.Need(",");
    value.numbers = Numbers(in, 4);
    for (const double part : value.numbers)
      if (part != std::round(part)) throw Refusal{"a whole number expected"};
    in.Need(",");
    value.eax = Numbers(in, 6);
  } else {
    throw Refusal{"an unknown type " + type};
  }
  in.Need("]");
  return value;
}

std::optional<RapidValue> PredefinedRapid(const std::string& type, const std::string& name) {
  RapidValue value;
  value.type = type;
  const auto numbered = [&](char letter) {
    return name.size() > 1 && name[0] == letter &&
           name.find_first_not_of("0123456789", 1) == std::string::npos;
  };
  if (type == "SPEEDDATA" && numbered('V')) {
    value.numbers = {std::strtod(name.c_str() + 1, nullptr), 500, 5000, 1000};
    return value;
  }
  if (type != "ZONEDATA") return std::nullopt;
  value.fine = name == "FINE";
  if (value.fine) return value;
  if (!numbered('Z')) return std::nullopt;
  const double size = name == "Z0" ? 0.3 : std::strtod(name.c_str() + 1, nullptr);
  value.numbers = {size, 1.5 * size, 1.5 * size, 0.15 * size, 1.5 * size, 0.15 * size};
  return value;
}

}  // namespace millpose::campaign
