// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_space.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

constexpr size_t kLengths = 3;  // coordinates before the angles
constexpr double kStepsPerDegree = 10;

/// Of a coordinate as people read it: whole mm, tenths of a degree.
double Raster(double shown, size_t i) {
  return i < kLengths ? std::round(shown) : std::round(shown * kStepsPerDegree) / kStepsPerDegree;
}

}  // namespace

PlaceSpace::PlaceSpace(const JobSettings& job, const PoseSettings& base_in_world) : own_(job.workpiece.pose) {
  if (!job.placement)
    throw InputError({job.file},
                     "placement: missing; it says where the part may be placed, like\n"
                     "placement:\n  x_mm: {from: 1500, to: 2100}");
  if (job.placement->moves == PlaceMoves::kRobot) {
    if (job.workpiece.frame == GivenFrame::kRobotBase)
      throw InputError({job.file},
                       "workpiece.frame: robot_base, so that the part would go along with the robot "
                       "(placement.moves: robot); give its pose in the world");
    own_ = base_in_world;
  } else if (!job.workpiece.targets.empty())
    throw InputError({job.file},
                     "workpiece.targets: these measure where the part is already; to search a place give "
                     "workpiece.pose");
  ranges_ = job.placement->ranges;
  for (size_t i = 0; i < ranges_.size(); ++i)
    if (ranges_[i]) free_.push_back(i);
}

PoseSettings PlaceSpace::At(std::span<const double> shares, const PoseSettings& rest) const {
  PoseSettings place = rest;
  for (size_t d = 0; d < free_.size(); ++d) {
    const PlaceRange& range = Range(d);
    CoordinateOf(place, free_[d]) = range.from + shares[d] * (range.to - range.from);
  }
  for (size_t i = 0; i < ranges_.size(); ++i) {
    if (!ranges_[i]) continue;
    const double shown = Raster(ShownCoordinate(place, i), i);
    CoordinateOf(place, i) = i < kLengths ? shown : DegToRad(shown);
  }
  return place;
}

double& CoordinateOf(PoseSettings& place, size_t i) {
  return i < kLengths ? place.position[static_cast<Eigen::Index>(i)]
                      : place.abc[static_cast<Eigen::Index>(i - kLengths)];
}

double CoordinateOf(const PoseSettings& place, size_t i) {
  return i < kLengths ? place.position[static_cast<Eigen::Index>(i)]
                      : place.abc[static_cast<Eigen::Index>(i - kLengths)];
}

double ShownCoordinate(const PoseSettings& place, size_t i) {
  constexpr double kPerDegree = 1e9;  // finer is the rounding from radians
  const double value = CoordinateOf(place, i);
  return (i < kLengths ? value : std::round(RadToDeg(value) * kPerDegree) / kPerDegree) + 0.0;  // no -0
}

std::array<double, 6> KeyOf(const PoseSettings& place) {
  std::array<double, 6> key{};
  for (size_t i = 0; i < key.size(); ++i) key[i] = ShownCoordinate(place, i);
  return key;
}

std::string Describe(const PoseSettings& place) {
  return fmt::format("({}, {}, {}) mm, ({}, {}, {})°", ShownCoordinate(place, 0), ShownCoordinate(place, 1),
                     ShownCoordinate(place, 2), ShownCoordinate(place, 3), ShownCoordinate(place, 4),
                     ShownCoordinate(place, 5));
}

}  // namespace millpose
