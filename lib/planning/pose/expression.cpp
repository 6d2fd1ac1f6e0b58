// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "machine/stiffness/indices_block.hpp"

namespace millpose {
namespace {

enum Code : int {
  kLambdaT1,
  kLambdaT2,
  kLambdaN,
  kMu,
  kNormal,
  kInPlane,
  kWorstInPlane,
  kAlongAxis,
  kUnderForce,
  kIndexCount,
  kMin = kIndexCount,
  kMax,
  kSqrt,
  kAbs,
  kSin,
  kCos,
  kAsin,
  kAcos,
  kAtan2,
  kNamedCount,
  kNumber = kNamedCount,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kNegate,
};

struct Named {
  const char* name;
  int least, most;  // arguments; 0: an index
  int mm, newton;   // exponents of its unit
};

constexpr int kMostArguments = 16, kMostSteps = 256, kMostDepth = 32;
constexpr std::array<Named, kNamedCount> kNamed{{{"lambda_t1_mm_N", 0, 0, 1, -1},
                                                 {"lambda_t2_mm_N", 0, 0, 1, -1},
                                                 {"lambda_n_mm_N", 0, 0, 1, -1},
                                                 {"mu", 0, 0, 0, 0},
                                                 {"normal_deflection_mm_N", 0, 0, 1, -1},
                                                 {"in_plane_deflection_mm_N", 0, 0, 1, -1},
                                                 {"worst_in_plane_mm_N", 0, 0, 1, -1},
                                                 {"axis_deflection_mm_N", 0, 0, 1, -1},
                                                 {"force_deflection_mm", 0, 0, 1, 0},
                                                 {"min", 2, kMostArguments, 0, 0},
                                                 {"max", 2, kMostArguments, 0, 0},
                                                 {"sqrt", 1, 1, 0, 0},
                                                 {"abs", 1, 1, 0, 0},
                                                 {"sin", 1, 1, 0, 0},
                                                 {"cos", 1, 1, 0, 0},
                                                 {"asin", 1, 1, 0, 0},
                                                 {"acos", 1, 1, 0, 0},
                                                 {"atan2", 2, 2, 0, 0}}};

bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

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

struct UnitOfStep {
  double mm = 0, newton = 0;
  bool mixed = false;
};

// NaN where one of the two is.
double Lesser(double a, double b) { return a != a || a < b ? a : b; }
double Greater(double a, double b) { return a != a || a > b ? a : b; }

// Of two numbers or of the first; NaN where it is not defined.
double Applied(int code, double a, double b) {
  constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  switch (code) {
    case kMin:
      return Lesser(a, b);
    case kMax:
      return Greater(a, b);
    case kSqrt:
      return std::sqrt(a);
    case kAbs:
      return std::fabs(a);
    case kSin:
      return std::fabs(a) <= 1e5 ? SinCos(a).sin : kUndefined;
    case kCos:
      return std::fabs(a) <= 1e5 ? SinCos(a).cos : kUndefined;
    case kAsin:
      return std::fabs(a) <= 1 ? Asin(a) : kUndefined;
    case kAcos:
      return std::fabs(a) <= 1 ? Acos(a) : kUndefined;
    case kAtan2:
      return std::fabs(a) < 1e300 && std::fabs(b) < 1e300 ? Atan2(a, b) : kUndefined;
    case kAdd:
      return a + b;
    case kSubtract:
      return a - b;
    case kMultiply:
      return a * b;
    case kDivide:
      return a / b;
    default:
      return -a;
  }
}

// All indices that one of the steps reads.
void FillIndices(const std::vector<Expression::Step>& steps, const ComplianceBlock& c,
                 const ObjectiveContext& context, std::array<Lanes, kIndexCount>& out) {
  const auto reads = [&](int first, int last) {
    return std::ranges::any_of(steps, [&](const auto& s) { return s.code >= first && s.code <= last; });
  };
  if (reads(kLambdaT1, kMu)) {
    PlaneIndicesBlock indices;
    IndicesInPlane(c, context.normal, indices);
    out[kLambdaT1] = indices.lambda_t1;
    out[kLambdaT2] = indices.lambda_t2;
    out[kLambdaN] = indices.lambda_n;
    out[kMu] = indices.mu;
  }
  PlaneDeflectionsBlock deflections;
  if (reads(kNormal, kWorstInPlane)) {
    DeflectionsInPlane(c, context.normal, deflections);
    out[kNormal] = deflections.normal;
    out[kInPlane] = deflections.in_plane;
    out[kWorstInPlane] = deflections.largest;
  }
  if (reads(kAlongAxis, kAlongAxis)) {
    DeflectionsInPlane(c, context.tool_axis, deflections);
    out[kAlongAxis] = deflections.normal;
  }
  if (!reads(kUnderForce, kUnderForce)) return;
  const double fx = context.force.x(), fy = context.force.y(), fz = context.force.z();
  for (int i = 0; i < kLanes; ++i) {
    const double x = c.xx.v[i] * fx + c.xy.v[i] * fy + c.xz.v[i] * fz;
    const double y = c.xy.v[i] * fx + c.yy.v[i] * fy + c.yz.v[i] * fz;
    const double z = c.xz.v[i] * fx + c.yz.v[i] * fy + c.zz.v[i] * fz;
    out[kUnderForce].v[i] = std::sqrt(x * x + y * y + z * z);
  }
}

/// Minimises an expression; that is its name too, so that keys and reports tell one from another.
class ExpressionObjective final : public Objective {
 public:
  explicit ExpressionObjective(const std::string& text) : text_(text), expression_(text) {}
  std::string Name() const override { return text_; }
  std::string Unit() const override { return expression_.Unit(); }
  bool DependsOnFeed() const override { return NeedsForce(); }
  bool NeedsForce() const override { return expression_.ReadsForce(); }
  bool ReadsToolAxis() const override { return expression_.ReadsToolAxis(); }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override {
    expression_.Evaluate(c, context, out);
  }

 private:
  std::string text_;
  Expression expression_;
};

}  // namespace

Expression::Expression(std::string_view text) { ExpressionParser(text, steps_).Run(); }

bool Expression::Looks(std::string_view text) {
  const bool word = !text.empty() && IsLetter(text.front()) &&
                    std::ranges::all_of(text, [](char c) { return IsLetter(c) || IsDigit(c); });
  const auto* const found = std::ranges::find(kNamed, text, &Named::name);
  return !word || found - kNamed.begin() < kIndexCount;
}

std::vector<std::string> Expression::Names() {
  std::vector<std::string> names;
  for (const Named& named : kNamed) names.emplace_back(named.name);
  return names;
}

bool Expression::ReadsForce() const {
  return std::ranges::any_of(steps_, [](const Step& step) { return step.code == kUnderForce; });
}

bool Expression::ReadsToolAxis() const {
  return std::ranges::any_of(steps_, [](const Step& step) { return step.code == kAlongAxis; });
}

std::string Expression::Unit() const {
  std::vector<UnitOfStep> stack;
  for (const Step& step : steps_) {
    UnitOfStep unit;
    if (step.code < kIndexCount)
      unit = {static_cast<double>(kNamed[step.code].mm), static_cast<double>(kNamed[step.code].newton),
              false};
    if (step.arguments > 0) {
      const auto first = stack.end() - step.arguments;
      unit = *first;
      for (auto other = first + 1; other != stack.end(); ++other) {
        unit.mixed = unit.mixed || other->mixed;
        if (step.code == kMultiply || step.code == kDivide) {
          const double sign = step.code == kMultiply ? 1 : -1;
          unit.mm += sign * other->mm;
          unit.newton += sign * other->newton;
        } else {
          unit.mixed = unit.mixed || other->mm != unit.mm || other->newton != unit.newton;
        }
      }
      if (step.code == kSqrt) {
        unit.mm /= 2;
        unit.newton /= 2;
      }
      if (step.code >= kSin && step.code <= kAtan2) unit.mm = unit.newton = 0;
      stack.erase(first, stack.end());
    }
    stack.push_back(unit);
  }
  const UnitOfStep& unit = stack.back();
  if (unit.mixed) return "mixed";
  const auto power = [](const char* name, double exponent) {
    return exponent == 1 ? std::string(name) : fmt::format("{}^{}", name, exponent);
  };
  std::string text = unit.mm > 0 ? power("mm", unit.mm) : "";
  if (unit.newton > 0) text += (text.empty() ? "" : "*") + power("N", unit.newton);
  if (text.empty()) text = "1";
  if (unit.mm < 0) text += "/" + power("mm", -unit.mm);
  if (unit.newton < 0) text += "/" + power("N", -unit.newton);
  return text;
}

void Expression::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  std::array<Lanes, kIndexCount> indices;
  FillIndices(steps_, c, context, indices);
  for (int i = 0; i < kLanes; ++i) {
    std::array<double, kMostSteps> stack;
    stack[0] = 0;
    int size = 0;
    bool defined = true;
    for (const Step& step : steps_) {
      if (step.code < kIndexCount) {
        stack[size++] = indices[step.code].v[i];
        defined = defined && std::isfinite(indices[step.code].v[i]);
      } else if (step.code == kNumber) {
        stack[size++] = step.number;
      } else {
        size -= step.arguments - 1;
        double& value = stack[size - 1];
        if (step.arguments == 1) value = Applied(step.code, value, value);
        for (int k = 1; k < step.arguments; ++k) value = Applied(step.code, value, stack[size - 1 + k]);
      }
    }
    const double value = stack[0];
    out.v[i] =
        defined && value >= 0 && std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
  }
}

std::vector<std::string> ObjectiveIndexNames() {
  std::vector<std::string> names = Expression::Names();
  names.resize(kIndexCount);
  return names;
}

std::vector<Lanes> ObjectiveIndices(const ComplianceBlock& c, const ObjectiveContext& context) {
  std::vector<Expression::Step> all;
  for (int code = 0; code < kIndexCount; ++code) all.push_back({code, 0});
  std::array<Lanes, kIndexCount> indices;
  FillIndices(all, c, context, indices);
  return {indices.begin(), indices.end()};
}

ObjectiveEntry ExpressionEntry(const std::string& text) {
  return {
      text, {}, [text](const ObjectiveParameters&) { return std::make_unique<ExpressionObjective>(text); }};
}

}  // namespace millpose
