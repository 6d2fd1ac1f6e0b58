// SPDX-License-Identifier: GPL-3.0-or-later
// The places that a job's `placement:` allows.
#pragma once

#include <span>

#include "job/config/job_settings.hpp"

namespace millpose {

/// Places as poses of the workpiece in `workpiece.frame`, or of the robot's base in W, on a raster of 1 mm
/// and 0.1°: finer no part is set down, and what numbers are the same place is then beyond doubt.
class PlaceSpace {
 public:
  /// Throws InputError where the job has no `placement:`, where measured targets say where the part stands
  /// that is to move, and where the part would go along with the robot.
  PlaceSpace(const JobSettings& job, const PoseSettings& base_in_world);

  /// How many coordinates may change.
  size_t dimensions() const { return free_.size(); }
  /// Of a free dimension: which coordinate (as kPlaceKeys) it is.
  size_t Coordinate(size_t dimension) const { return free_[dimension]; }
  const PlaceRange& Range(size_t dimension) const { return *ranges_[free_[dimension]]; }

  /// The place at `shares` (0..1, one per dimension) of the ranges; what has no range is as in `rest`.
  PoseSettings At(std::span<const double> shares, const PoseSettings& rest) const;
  /// The same, the rest as in the job.
  PoseSettings At(std::span<const double> shares) const { return At(shares, own_); }
  /// The job's own place, not on the raster.
  const PoseSettings& own() const { return own_; }

 private:
  PoseSettings own_;
  std::array<std::optional<PlaceRange>, 6> ranges_;
  std::vector<size_t> free_;
};

/// Coordinate `i` (as kPlaceKeys) of a place, mm or rad.
double& CoordinateOf(PoseSettings& place, size_t i);
double CoordinateOf(const PoseSettings& place, size_t i);

/// The same as people read it: mm or degrees.
double ShownCoordinate(const PoseSettings& place, size_t i);

/// All of them: places with the same are the same.
std::array<double, 6> KeyOf(const PoseSettings& place);

/// "(1850, 0, 1200) mm, (0, -90, 0)°".
std::string Describe(const PoseSettings& place);

}  // namespace millpose
