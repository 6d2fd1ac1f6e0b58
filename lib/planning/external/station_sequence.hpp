// SPDX-License-Identifier: GPL-3.0-or-later
// At which station each pass is milled (docs/external-axes.md).
#pragma once

#include <cstddef>
#include <vector>

namespace millpose {

/// What a sample of a pass's points comes to at a station.
struct StationScore {
  size_t lost = 0;            ///< points without a free pose
  double worst = 0, sum = 0;  ///< objective over the others

  bool operator<(const StationScore& other) const;  ///< better: fewer lost, then the lesser worst, then sum
};

/// One way to mill a pass: from which station to which, and what that is worth. Stations that do not move
/// along the pass are both the same.
struct CourseScore {
  size_t from = 0, to = 0;
  StationScore score;
};

struct StationSequence {
  /// Of each pass: its station (or choice), then others, the best first.
  std::vector<std::vector<size_t>> ranked;
  size_t lost = 0, changes = 0;
  double worst = 0;  ///< 0 where the sum alone counts
  double sum = 0;    ///< of the objective over the sampled points

  bool IsBetter(const StationSequence& other) const;
};

/// What a change of station must gain, as a share of a pass's objective.
inline constexpr double kChangePrice = 0.05;

/// `choices[pass]`. Every pass loses as few points as it can anywhere; with `worst_first` no sampled point is
/// worse than the worst of all must be; of what is left the sequence with the least sum of the objective,
/// each pass's in shares of its own best, and kChangePrice for every change: where a pass does not begin at
/// the station at which the one before ends. `next`: how many other choices each pass is given.
StationSequence FindCourseSequence(const std::vector<std::vector<CourseScore>>& choices, bool worst_first,
                                   size_t next);

}  // namespace millpose
