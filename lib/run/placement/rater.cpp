// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/rater.hpp"

namespace millpose {
namespace {

constexpr double kApart = 0.1;  // of every range: of places nearer than that one is planned

}  // namespace

RatedPlace Rater::Rate(PlaceScore score) {
  RatedPlace rated;
  double worst = 0, mean = 0;
  bool all = score.touches.empty();
  for (size_t i = 0; i < reference_.size(); ++i) {
    const OperationScore& own = score.operations[i];
    if (own.points.front() == 0) {
      all = false;
      continue;
    }
    // Where the job's own place has no free point, the first that has one stands for it.
    if (reference_[i].worst <= 0) reference_[i] = own;
    worst = std::max(worst, own.worst / reference_[i].worst);
    mean = std::max(mean, own.mean / reference_[i].mean);
  }
  if (all) {
    rated.worst = worst;
    rated.mean = mean;
  }
  // What is missing before the worst, the worst before the mean; bounded, so that no place is all that a
  // search sees.
  const double missing =
      1 - static_cast<double>(score.free()) / static_cast<double>(std::max<size_t>(1, score.total()));
  rated.value = worst / (1 + worst) + 1e-3 * mean / (1 + mean);
  if (missing > 0 || !all) rated.value = 2 + missing + 0.01 * rated.value;
  rated.score = std::move(score);
  return rated;
}

std::vector<PoseSettings> BestPlaces(const PlaceSpace& space, std::vector<RatedPlace> places, size_t count) {
  std::ranges::stable_sort(places, {}, &RatedPlace::value);
  const auto near = [&](const PoseSettings& a, const PoseSettings& b) {
    for (size_t d = 0; d < space.dimensions(); ++d) {
      const PlaceRange& range = space.Range(d);
      const size_t i = space.Coordinate(d);
      if (std::abs(CoordinateOf(a, i) - CoordinateOf(b, i)) > kApart * (range.to - range.from)) return false;
    }
    return true;
  };
  std::vector<PoseSettings> best;
  for (const RatedPlace& rated : places) {
    if (best.size() >= count) break;
    const PoseSettings& place = rated.score.place;
    if (!rated.score.touches.empty() || rated.score.free() == 0) continue;
    if (std::ranges::none_of(best, [&](const PoseSettings& other) { return near(place, other); }))
      best.push_back(place);
  }
  return best;
}

}  // namespace millpose
