// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/expression_parser.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"

namespace millpose::expression {
namespace {

class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, std::vector<Expression::Step>& steps)
      : text_(text), steps_(steps) {}

  void Run() {
    Sum(0);
    if (ok_ && Peek() != '\0') Stop("given \"" + Given() + "\"; allowed: an operator (+ - * /) or the end");
    if (problems_.empty() &&
        std::ranges::none_of(steps_, [](const auto& step) { return step.code < kIndexCount; }))
      Add(0, "names no index, so all poses are the same; known: " + Listed());
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }

 private:
  static std::string Listed() {
    std::string listed;
    for (const Named& named : kNamed) listed += (listed.empty() ? "" : ", ") + std::string(named.name);
    return listed;
  }
  char Peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  // The character that stands here, whole where it is more than a byte.
  std::string Given() {
    if (Peek() == '\0') return "the end";
    size_t end = at_ + 1;
    while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0) == 0x80) ++end;
    return ValidUtf8(text_.substr(at_, end - at_));
  }
  void Add(size_t at, const std::string& message) {
    const auto before = text_.substr(0, at);
    const auto characters = std::ranges::count_if(before, [](char c) { return (c & 0xC0) != 0x80; });
    problems_.push_back({SourceLocation{}, fmt::format("at character {}: {}", characters + 1, message)});
  }
  void Stop(const std::string& message) {
    if (ok_) Add(at_, message);
    ok_ = false;
  }
  void Emit(int code, int arguments, double number = 0) {
    if (steps_.size() == kMostSteps)
      Stop(fmt::format("too long; allowed: {} numbers, names and operators", kMostSteps));
    if (ok_) steps_.push_back({code, arguments, number});
  }
  bool Take(char c) {
    if (!ok_ || Peek() != c) return false;
    ++at_;
    return true;
  }

  void Sum(int depth) {
    Product(depth);
    for (bool more = true; more && ok_;) {
      more = false;
      for (const auto& [sign, code] : {std::pair{'+', kAdd}, {'-', kSubtract}})
        if (Take(sign)) {
          Product(depth);
          Emit(code, 2);
          more = true;
        }
    }
  }
  void Product(int depth) {
    Factor(depth);
    for (bool more = true; more && ok_;) {
      more = false;
      for (const auto& [sign, code] : {std::pair{'*', kMultiply}, {'/', kDivide}})
        if (Take(sign)) {
          Factor(depth);
          Emit(code, 2);
          more = true;
        }
    }
  }
  void Factor(int depth) {
    if (!ok_) return;
    if (depth > kMostDepth) return Stop(fmt::format("nested too deep; allowed: {} levels", kMostDepth));
    if (Take('-')) {
      Factor(depth + 1);
      return Emit(kNegate, 1);
    }
    if (Take('(')) {
      Sum(depth + 1);
      if (ok_ && !Take(')')) Stop("given \"" + Given() + "\"; allowed: an operator (+ - * /) or )");
      return;
    }
    const char c = Peek();
    if (IsLetter(c)) return Name(depth);
    if (IsDigit(c) || c == '.') return Number();
    Stop("given \"" + Given() + "\"; allowed: a number, a name, ( or -");
  }
  void Number() {
    size_t end = at_;
    while (end < text_.size() &&
           (IsDigit(text_[end]) || IsLetter(text_[end]) || text_[end] == '.' ||
            ((text_[end] == '-' || text_[end] == '+') && (text_[end - 1] == 'e' || text_[end - 1] == 'E'))))
      ++end;
    const std::string_view word = text_.substr(at_, end - at_);
    const std::optional<double> number = ParseNumber(word);
    if (!number) return Stop(fmt::format("given \"{}\"; allowed: a number", word));
    at_ = end;
    Emit(kNumber, 0, *number);
  }
  void Name(int depth) {
    const size_t start = at_;
    while (at_ < text_.size() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) ++at_;
    const std::string_view word = text_.substr(start, at_ - start);
    const auto* const found = std::ranges::find(kNamed, word, &Named::name);
    int arguments = 0;
    if (Take('(')) {
      do {
        Sum(depth + 1);
        ++arguments;
      } while (Take(','));
      if (ok_ && !Take(')')) Stop("given \"" + Given() + "\"; allowed: an operator (+ - * /), a comma or )");
    }
    // The rest is read all the same, so that every name that is not known is told.
    if (found == kNamed.end())
      Add(start, UnknownName("index or function", std::string(word), Expression::Names()));
    else if (arguments < found->least || arguments > found->most)
      Add(start,
          fmt::format("{} is given {} arguments; allowed: {}", word, arguments,
                      found->most == 0              ? std::string("none, it is an index")
                      : found->least == found->most ? std::to_string(found->least)
                                                    : fmt::format("{} to {}", found->least, found->most)));
    Emit(static_cast<int>(found - kNamed.begin()), arguments);
  }

  std::string_view text_;
  std::vector<Expression::Step>& steps_;
  size_t at_ = 0;
  bool ok_ = true;
  std::vector<Problem> problems_;
};

}  // namespace

void Parse(std::string_view text, std::vector<Expression::Step>& steps) {
  ExpressionParser(text, steps).Run();
}

}  // namespace millpose::expression
