// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/interval_end.hpp"

namespace millpose {

double IntervalEnd(const PointScorer& scorer, const FreedomValues& inside, size_t dimension, int branch,
                   double outside, double tolerance, int& evaluations) {
  std::vector<double> lanes;
  for (int l = 0; l < kLanes; ++l) lanes.insert(lanes.end(), inside.begin(), inside.end());
  ScoredBlock block;
  double within = inside[dimension];
  while (std::abs(outside - within) > tolerance) {
    const double part = (outside - within) / (kLanes + 1);
    const double begin = within;
    for (int l = 0; l < kLanes; ++l) lanes[l * inside.size() + dimension] = begin + (l + 1) * part;
    scorer.ScoreBlock(lanes, 1u << (branch & 3), block);
    evaluations += kLanes;
    int count = 0;
    while (count < kLanes && block.obstacle[branch][count] == Infeasibility::kNone) ++count;
    if (count > 0) within = begin + count * part;
    if (count < kLanes) outside = begin + (count + 1) * part;
    if (part == 0.0 || outside == within) break;
  }
  return within;
}

}  // namespace millpose
