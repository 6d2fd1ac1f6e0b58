// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of a neighbouring layer that a step can come from or go to.
#pragma once

#include <algorithm>
#include <tuple>

#include "base/units.hpp"
#include "path/layer.hpp"

namespace millpose {

/// Nodes between `begin` and `end` that can be reached from the place `at` without leaping over one that was
/// pruned; where `at` itself is in a blocked stretch, from both its sides.
inline std::pair<size_t, size_t> WithinWalls(const Layer& layer, size_t begin, size_t end, size_t at) {
  const auto blocked = [&](size_t node) { return !std::isfinite(layer.objective[node]); };
  size_t first = at, last = at;
  while (first > begin && blocked(first - 1)) --first;
  while (first > begin && !blocked(first - 1)) --first;
  while (last < end && blocked(last)) ++last;
  while (last < end && !blocked(last)) ++last;
  return {first, last};
}

/// Calls `visit(first, last)` for the ranges of nodes of `branch` whose first freedom lies within `band` of
/// `value`, round the turn too; with `walls` as LadderProblem says.
template <typename Visit>
void VisitBand(const Layer& layer, int branch, double value, double band, bool walls, const Visit& visit) {
  const auto begin = layer.first.begin();
  const size_t from = layer.branch_begin[branch], to = layer.branch_begin[branch + 1];
  if (band >= kPi && !walls) return visit(from, to);
  const auto part = [&](double middle) {
    size_t first = static_cast<size_t>(std::lower_bound(begin + from, begin + to, middle - band) - begin);
    size_t last = static_cast<size_t>(std::upper_bound(begin + first, begin + to, middle + band) - begin);
    if (walls) {
      const size_t at = static_cast<size_t>(std::lower_bound(begin + first, begin + last, middle) - begin);
      std::tie(first, last) = WithinWalls(layer, first, last, at);
    }
    if (first != last) visit(first, last);
  };
  part(value);
  if (value - band < -kPi) part(value + 2 * kPi);
  if (value + band > kPi) part(value - 2 * kPi);
}

}  // namespace millpose
