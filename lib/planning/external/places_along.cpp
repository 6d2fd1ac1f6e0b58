// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/external/places_along.hpp"

#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

/// Lets each motion go to the next place.
void Join(const CoordinatedMotion& like, std::vector<PlaceAlong>& places) {
  for (size_t t = 0; t < places.size(); ++t) {
    CoordinatedMotion ride = like;
    ride.from = places[t].external;
    ride.to = places[std::min(t + 1, places.size() - 1)].external;
    places[t].onward = places[t].standing;
    places[t].onward.ride = std::make_shared<const CoordinatedMotion>(std::move(ride));
  }
}

}  // namespace

std::vector<PlaceAlong> MakePlacesAlong(const Stations& stations,
                                        const std::vector<ExternalPosition>& external) {
  const Cell& cell = stations.world().cell();
  const Mechanism mechanism(cell.external_axes);
  std::vector<PlaceAlong> places;
  for (const ExternalPosition& position : external) {
    PlaceAlong& place = places.emplace_back();
    place.station = stations.Own(position);
    place.external = position;
    place.X_WP = mechanism.Moved(Carries::kWorkpiece, position) * cell.X_WP;
    const PoseProblem& problem = place.station->problem;
    place.standing = {problem.arm, problem.X_WB, problem.X_FT};
  }
  Join({mechanism, cell.X_WB, cell.X_WP, {}, {}}, places);
  return places;
}

std::vector<PlaceAlong> Selected(std::span<const PlaceAlong> places, std::span<const size_t> points) {
  std::vector<PlaceAlong> selected;
  for (const size_t point : points) selected.push_back(places[point]);
  if (!selected.empty()) Join(*places.front().onward.ride, selected);
  return selected;
}

MillingPoint OnPart(const PlaceAlong& place, const MillingPoint& point) {
  Pass one;
  one.points.push_back(point);
  Transform(place.X_WP.inverse(Eigen::Isometry), one);
  return std::move(one.points.front());
}

std::vector<Eigen::Vector3d> MiddlesAlong(std::span<const PlaceAlong> places,
                                          std::span<const MillingPoint> points) {
  std::vector<Eigen::Vector3d> on_part, middles;
  for (size_t t = 0; t < points.size(); ++t)
    on_part.emplace_back(places[t].X_WP.inverse(Eigen::Isometry) * points[t].position);
  for (size_t t = 0; t < points.size(); ++t) {
    const Eigen::Vector3d middle = 0.5 * (on_part[t] + on_part[std::min(t + 1, points.size() - 1)]);
    middles.emplace_back(places[t].onward.BasePose(0.5).inverse(Eigen::Isometry) * middle);
  }
  return middles;
}

}  // namespace millpose
