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
#include "planning/pose/expression_parser.hpp"

namespace millpose {
namespace {

using namespace expression;

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

Expression::Expression(std::string_view text) { Parse(text, steps_); }

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
