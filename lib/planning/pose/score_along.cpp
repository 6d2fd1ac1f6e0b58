// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/score_along.hpp"

namespace millpose {

std::array<Candidate, kLanes> ScoreAlong(const PointScorer& scorer, const FreedomValues& freedoms,
                                         size_t dimension, const std::array<double, kLanes>& values,
                                         int branch) {
  const size_t dimensions = freedoms.size();
  std::vector<double> lanes(kLanes * dimensions);
  for (size_t l = 0; l < kLanes; ++l) {
    std::ranges::copy(freedoms, lanes.begin() + static_cast<std::ptrdiff_t>(l * dimensions));
    lanes[l * dimensions + dimension] = values[l];
  }
  ScoredBlock block;
  scorer.ScoreBlock(lanes, 1u << (branch & 3), block);
  std::array<Candidate, kLanes> candidates;
  for (int l = 0; l < kLanes; ++l) candidates[static_cast<size_t>(l)] = CandidateOf(block, branch, l);
  return candidates;
}

}  // namespace millpose
