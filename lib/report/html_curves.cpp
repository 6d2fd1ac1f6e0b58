// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "base/units.hpp"
#include "report/html_columns.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"

namespace millpose {
namespace {

/// Objectives beyond this many times the least of a point are drawn at the upper edge.
constexpr double kCurveSpan = 8;
constexpr uint16_t kNoValue = 65535;

PackedCurve PackCurve(const PointCurves& curves) {
  const size_t count = curves.state.size();
  PackedCurve packed{curves.pass, curves.point, 0, 0, {}, {}, curves.best, curves.mean};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  std::vector<double> values;
  for (size_t arm = 0; arm < 4; ++arm) {
    for (size_t i = 0; i < count; ++i) {
      double value = std::numeric_limits<double>::infinity();
      for (const size_t branch : {arm, arm + 4})
        if (curves.state[i][branch] != Infeasibility::kUnreachable)
          value = std::min(value, curves.objective[i][branch]);
      values.push_back(value);
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  if (std::isfinite(least)) {
    packed.least = static_cast<float>(least);
    packed.span = static_cast<float>(std::min(most, kCurveSpan * std::abs(least)) - least);
  }
  for (double value : values) {
    const double share = packed.span > 0 ? (value - least) / packed.span : 0;
    packed.values.push_back(std::isfinite(value)
                                ? static_cast<uint16_t>(std::lround(65534 * std::clamp(share, 0.0, 1.0)))
                                : kNoValue);
  }
  for (size_t i = 0; i < count; ++i) {
    unsigned bits = 0;
    for (size_t branch = 0; branch < 8; ++branch)
      bits |= static_cast<unsigned>(TestsPassed(curves.state[i][branch])) << (2 * branch);
    packed.states.push_back(static_cast<uint16_t>(bits));
  }
  return packed;
}

void AppendPadded(const std::vector<double>& values, size_t size, double scale, std::vector<float>& out) {
  for (size_t i = 0; i < size; ++i) {
    const bool known = i < values.size() && std::isfinite(values[i]);
    out.push_back(known ? static_cast<float>(scale * values[i]) : std::numeric_limits<float>::quiet_NaN());
  }
}

}  // namespace

std::vector<PackedCurve> Packed(const std::vector<PointCurves>& curves) {
  std::vector<PackedCurve> packed;
  for (const PointCurves& of_point : curves) packed.push_back(PackCurve(of_point));
  return packed;
}

namespace html {

Json CurvesJson(const HtmlInput& input) {
  const double scale = ShownScale(input.plan.objective_unit);
  std::vector<uint32_t> first_number;
  uint32_t total = 0;
  for (const PassResult& pass : input.plan.passes) {
    first_number.push_back(total);
    total += static_cast<uint32_t>(pass.points.size());
  }
  size_t generations = 0;
  for (const PackedCurve& curve : input.curves) generations = std::max(generations, curve.best.size());

  std::vector<uint32_t> number;
  std::vector<float> least, span, best, mean;
  std::vector<uint16_t> values, states;
  for (const PackedCurve& packed : input.curves) {
    assert(static_cast<int>(packed.states.size()) == input.grid.count);
    number.push_back(first_number[packed.pass] + static_cast<uint32_t>(packed.point));
    least.push_back(static_cast<float>(scale) * packed.least);
    span.push_back(static_cast<float>(scale) * packed.span);
    values.insert(values.end(), packed.values.begin(), packed.values.end());
    states.insert(states.end(), packed.states.begin(), packed.states.end());
    AppendPadded(packed.best, generations, scale, best);
    AppendPadded(packed.mean, generations, scale, mean);
  }
  return {{"first_deg", RadToDeg(input.grid.first)},
          {"step_deg", RadToDeg(input.grid.step)},
          {"count", input.grid.count},
          {"generations", generations},
          {"number", PackUint32(number)},
          {"least", PackFloats(least)},
          {"span", PackFloats(span)},
          {"values", PackUint16(values)},
          {"states", PackUint16(states)},
          {"best", PackFloats(best)},
          {"mean", PackFloats(mean)}};
}

}  // namespace html
}  // namespace millpose
