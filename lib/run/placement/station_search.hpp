// SPDX-License-Identifier: GPL-3.0-or-later
// Between which stations a part is split, by its sampled points.
#pragma once

#include "run/placement/rater.hpp"

namespace millpose {

/// A place and what of the path is milled from it.
struct SplitStation {
  PathSection share;
  RatedPlace rated;  ///< of its share's sample, beside the job's own place
};

/// How a job is split, whatever the number of stations.
struct SplitRule {
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< P, unit
  double overlap = 0;                                ///< mm
};

/// Throws InputError for a job that cannot be split: one of several operations, one that is a share already,
/// a path that is not cut.
void CheckStations(const std::vector<JobInputs>& inputs);

/// Across what the job's path is split: as the job says, or the longest of x, y, z. Passes overlap by twice
/// the stations' error and a step-over, so that passes along a seam overlap too; holes, drilled as a whole,
/// do not.
SplitRule SplitRuleOf(const JobInputs& inputs, const Toolpath& toolpath);

class StationSearch {
 public:
  /// Scores `placement.places` places spread over the ranges (Halton). The references outlive it.
  StationSearch(const JobInputs& inputs, const PlaceSpace& space, const PlaceScorer& scorer, Rater& rater,
                const Execution& execution);

  const SplitRule& rule() const { return rule_; }
  /// The best split found between `count` stations, each looked for among the same number of places by its
  /// own share; empty where the sample does not reach so far.
  std::vector<SplitStation> Find(size_t count);

 private:
  SplitStation Improve(const PathSection& share, const std::vector<double>& start, int places);

  const JobInputs& inputs_;
  const PlaceSpace& space_;
  const PlaceScorer& scorer_;
  Rater& rater_;
  const Execution& execution_;
  SplitRule rule_;
  std::vector<std::vector<double>> shares_;  ///< of the ranges, of every place that was scored
  std::vector<std::vector<ScoredPoint>> rows_;
  std::vector<double> along_, seams_;
};

}  // namespace millpose
