// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/price.hpp"

#include <algorithm>
#include <array>

#include "planning/result/compared.hpp"

namespace millpose {

namespace {

/// A point's objective at its best candidate, its best free one, before smoothing, and on the path. The
/// searches look closely but not everywhere: what one of them found later counts for those before it too.
std::array<double, 4> Levels(const PlannedPoint& point) {
  std::array<double, 4> levels{point.free_optimum, point.free_optimum, point.unsmoothed, point.objective};
  for (const double own : {point.own_optimum, point.genetic_optimum})
    if (own > 0) levels[0] = std::min(levels[0], own);
  return levels;
}

PriceParts Differences(const std::array<double, 4>& levels) {
  PriceParts parts{levels[1] - levels[0], levels[2] - levels[1], levels[3] - levels[2], 0};
  parts.total = parts.interference + parts.continuity + parts.smoothing;
  return parts;
}

std::optional<double> Above(double value, double bound) {
  if (!(bound > 0)) return std::nullopt;
  return value / bound - 1;
}

}  // namespace

std::optional<Price> PriceOf(const PlanResult& plan) {
  Price price;
  price.is_length = plan.objective_unit == "mm";
  const PointFilter counts = Compared(plan.passes);
  std::array<double, 4> sum{}, worst{};
  LadderBound bound;
  for (const PassResult& pass : plan.passes) {
    bound.cost += pass.bound.cost;
    bound.cost_bound += pass.bound.cost_bound;
    bound.worst = std::max(bound.worst, pass.bound.worst);
    bound.worst_bound = std::max(bound.worst_bound, pass.bound.worst_bound);
    for (const PlannedPoint& point : pass.points) {
      if (!counts(point)) continue;
      ++price.points;
      const std::array<double, 4> levels = Levels(point);
      for (size_t i = 0; i < 4; ++i) {
        sum[i] += levels[i];
        worst[i] = std::max(worst[i], levels[i]);
      }
    }
  }
  if (price.points == 0) return std::nullopt;
  if (sum[0] > 0) {
    price.ratio = {sum[1] / sum[0], sum[2] / sum[1], sum[3] / sum[2], 0};
    price.ratio.total = price.ratio.interference * price.ratio.continuity * price.ratio.smoothing;
  }
  price.worst = Differences(worst);
  for (double& of_level : sum) of_level /= static_cast<double>(price.points);
  price.mean = Differences(sum);
  price.sum_gap = Above(bound.cost, bound.cost_bound);
  price.worst_gap = Above(bound.worst, bound.worst_bound);
  return price;
}

}  // namespace millpose
