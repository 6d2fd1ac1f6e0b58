// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/candidate_table.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {

CandidateTable CandidateTable::OfStep(const PointScorer& scorer, double step) {
  std::vector<int> intervals;
  for (const auto& freedom : scorer.problem().freedoms) {
    const double range = freedom->Upper() - freedom->Lower();
    intervals.push_back(std::max(1, static_cast<int>(std::ceil(range / step - 1e-9))));
  }
  return {scorer, intervals};
}

CandidateTable CandidateTable::OfSize(const PointScorer& scorer, int settings) {
  const size_t dimensions = scorer.problem().freedoms.size();
  int each = 2;
  const auto fits = [&](int count) {
    double product = 1;
    for (size_t d = 0; d < dimensions; ++d) product *= count;
    return product <= settings;
  };
  while (fits(each + 1)) ++each;
  std::vector<int> intervals;
  for (const auto& freedom : scorer.problem().freedoms)
    intervals.push_back(freedom->Periodic() ? each : each - 1);
  return {scorer, intervals};
}

CandidateTable::CandidateTable(const PointScorer& scorer, const std::vector<int>& intervals) {
  const auto& freedoms = scorer.problem().freedoms;
  const size_t dimensions = freedoms.size();
  for (size_t d = 0; d < dimensions; ++d) {
    counts_.push_back(intervals[d] + (freedoms[d]->Periodic() ? 0 : 1));
    lower_.push_back(freedoms[d]->Lower());
    step_.push_back((freedoms[d]->Upper() - freedoms[d]->Lower()) / intervals[d]);
    settings_ *= static_cast<size_t>(counts_[d]);
  }
  std::vector<double> values(kLanes * dimensions);
  ScoredBlock block;
  for (size_t first = 0; first < settings_; first += kLanes) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      size_t rest = std::min(first + lane, settings_ - 1);  // the last fills up
      for (size_t d = dimensions; d-- > 0; rest /= static_cast<size_t>(counts_[d]))
        values[lane * dimensions + d] = At(d, static_cast<int>(rest % static_cast<size_t>(counts_[d])));
    }
    scorer.ScoreBlock(values, kAllArmBranches, block);
    for (size_t lane = 0; lane < kLanes && first + lane < settings_; ++lane) {
      for (int branch = 0; branch < 8; ++branch) {
        const Obstacle obstacle = block.obstacle[branch][lane];
        if (obstacle != Obstacle::kNone) {
          reason_ = std::max(reason_, obstacle);
          continue;
        }
        const Candidate candidate = CandidateOf(block, branch, static_cast<int>(lane));
        entries_.push_back({static_cast<uint32_t>(first + lane), static_cast<uint8_t>(branch),
                            candidate.objective, candidate.q});
      }
    }
  }
  if (!entries_.empty()) reason_ = Obstacle::kNone;
}

FreedomValues CandidateTable::Setting(size_t index) const {
  FreedomValues values(counts_.size());
  for (size_t d = counts_.size(); d-- > 0; index /= static_cast<size_t>(counts_[d]))
    values[d] = At(d, static_cast<int>(index % static_cast<size_t>(counts_[d])));
  return values;
}

}  // namespace millpose
