// SPDX-License-Identifier: GPL-3.0-or-later
// Whether one path follows another: order, place and orientation.
#pragma once

#include <optional>
#include <vector>

#include "machine/motion/line.hpp"
#include "program/verify/replay.hpp"

namespace millpose {

/// How far a tool pose lies from a place of a path.
struct PathDeviation {
  double position = 0;  ///< mm
  double axis = 0;      ///< rad, of the tool axis
  double rotation = 0;  ///< rad, about the tool axis
  size_t segment = 0;   ///< of the path
  bool Within(const VerifyOptions& options) const;
  std::string Text() const;  ///< what exceeds, with units
};

/// Follows a path of straight segments from its beginning, never backwards.
class PathFollower {
 public:
  /// `path`: the tool's poses, at least one. `look_ahead`: how many segments may be passed over in one step.
  PathFollower(const std::vector<Pose>& path, size_t look_ahead, const VerifyOptions& options);

  /// Moves on to where `pose` fits within tolerance, staying on the segment as long as it fits. Where it fits
  /// nowhere ahead the follower stays and the nearest deviation is returned.
  PathDeviation Follow(const Pose& pose);
  /// How far `pose` lies from the place where the follower stands.
  PathDeviation Off(const Pose& pose) const;
  /// The segment where the follower stands.
  size_t segment() const { return segment_; }
  double share() const { return share_; }  ///< and how far along it

 private:
  PathDeviation Measure(const Pose& pose, size_t segment, double from, double& share) const;

  const VerifyOptions& options_;
  size_t look_ahead_;
  std::vector<PoseLine> lines_;
  size_t segment_ = 0;
  double share_ = 0;
};

}  // namespace millpose
