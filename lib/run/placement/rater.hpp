// SPDX-License-Identifier: GPL-3.0-or-later
// What places are worth beside the job's own.
#pragma once

#include "run/placement/place_score.hpp"

namespace millpose {

/// A scored place and what it comes to beside the job's own: below 1 is better.
struct RatedPlace {
  PlaceScore score;
  std::optional<double> worst, mean;  ///< ÷ the reference's; the greatest of the operations
  double value = 0;                   ///< what the search makes small
};

/// Rates places beside the first that it rates.
class Rater {
 public:
  explicit Rater(size_t operations) : reference_(operations) {}

  RatedPlace Rate(PlaceScore score);

 private:
  std::vector<OperationScore> reference_;
};

/// The best `count` places that differ by more than a tenth of some range, best first; none that the part
/// cannot stand in.
std::vector<PoseSettings> BestPlaces(const PlaceSpace& space, std::vector<RatedPlace> places, size_t count);

}  // namespace millpose
