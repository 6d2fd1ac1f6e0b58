// SPDX-License-Identifier: GPL-3.0-or-later
// How a part is best split between several places, by what its sampled points are worth in each.
#pragma once

#include <span>
#include <vector>

#include "planning/ladder/scored_point.hpp"

namespace millpose {

/// What some points are worth: those that are not free count first, then the worst, then the sum.
struct SplitCost {
  size_t missing = 0;
  double worst = 0, sum = 0;

  void Add(const ScoredPoint& point);
  /// Of parts side by side.
  SplitCost operator+(const SplitCost& other) const;
  auto operator<=>(const SplitCost&) const = default;
};

/// What is milled from one place: from a seam to the next.
struct SplitPart {
  size_t place = 0;
  double from = 0, to = 0;  ///< infinite at the part's ends
};

struct SplitProblem {
  std::span<const double> along;                   ///< where the points lie, mm
  std::span<const std::vector<ScoredPoint>> rows;  ///< of every place its points
  std::span<const double> seams;                   ///< where the part may be split, ascending, mm
  double overlap = 0;                              ///< parts run on by half of it beyond their seams, mm
};

/// The split into `count` parts that costs least; each holds a point. Empty where there is none.
std::vector<SplitPart> BestSplit(const SplitProblem& problem, size_t count);

}  // namespace millpose
