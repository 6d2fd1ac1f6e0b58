// SPDX-License-Identifier: GPL-3.0-or-later
// What a pass is planned in, point by point, while external axes move along it.
#pragma once

#include "machine/motion/line.hpp"
#include "planning/external/stations.hpp"

namespace millpose {

/// What one point is planned in.
struct PlaceAlong {
  std::shared_ptr<const Station> station;
  ExternalPosition external;
  Pose X_WP = Pose::Identity();
  Carrier standing;  ///< with the axes where they are at the point
  Carrier onward;    ///< of the straight motion to the next point, with its ride
};

/// Of points in their order, one position for each.
std::vector<PlaceAlong> MakePlacesAlong(const Stations& stations,
                                        const std::vector<ExternalPosition>& external);

/// The same of others of these points, in another order: each motion goes to the next of `points`.
std::vector<PlaceAlong> Selected(std::span<const PlaceAlong> places, std::span<const size_t> points);

/// A milling point in P, given in W with the part where it is there.
MillingPoint OnPart(const PlaceAlong& place, const MillingPoint& point);

/// Half-way of the straight motion from each of some points to the next, in B as it is then; the last stays.
std::vector<Eigen::Vector3d> MiddlesAlong(std::span<const PlaceAlong> places,
                                          std::span<const MillingPoint> points);

}  // namespace millpose
