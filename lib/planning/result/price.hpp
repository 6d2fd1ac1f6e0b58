// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// A whole and its three parts.
struct PriceParts {
  double interference = 0;  ///< from each point's best candidate to its best free one
  double continuity = 0;    ///< from there to the path before smoothing
  double smoothing = 0;     ///< from there to the path
  double total = 0;
};

/// What the objective on the path costs against each point's own best candidate, over the points that
/// Compared() counts (docs/price.md).
struct Price {
  size_t points = 0;
  /// The objective is a length: differences count. Else ratios do.
  bool is_length = false;
  PriceParts ratio;  ///< of sums; the total is the product of the parts; all 0 where the optima sum to 0
  PriceParts mean;   ///< differences of means, objective's unit; the total is the sum of the parts
  PriceParts worst;  ///< differences of the largest values, likewise
  /// How far the ladder search's answer is above its lower bound, relative: of the sum with joint motion,
  /// and of the largest objective where that was sought first.
  std::optional<double> sum_gap, worst_gap;
};

/// Empty without points.
std::optional<Price> PriceOf(const PlanResult& plan);

}  // namespace millpose
