// SPDX-License-Identifier: GPL-3.0-or-later
// Why a point has the pose that it has, in words.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace millpose {

/// A pose of a point.
struct PoseAt {
  double rotation = 0;   ///< about the tool axis, rad
  int branch = 0;        ///< status bits S
  double objective = 0;  ///< in the unit in which it is shown
};

/// A stiffer pose that is not admissible: too near a singularity, or a joint is beyond its limit.
struct ForbiddenPose {
  PoseAt pose;
  int joint = -1;     ///< 0..5; −1: singular
  double beyond = 0;  ///< rad
};

/// How far along the pass the best free pose of a point can be followed on its branch.
struct FollowedStretch {
  double length = 0;         ///< mm
  bool to_the_ends = false;  ///< of the piece, both
  std::string obstacle;      ///< what ends it
};

/// What the sentences are made of.
struct PoseReason {
  std::string skipped;  ///< of a skipped point: why; then nothing else counts
  std::string unit;
  PoseAt path, free, own;  ///< planned, best free, best with interference left aside
  double unsmoothed = 0;   ///< objective on the path before smoothing
  std::string barred;  ///< the pair that interferes at `own`: "link4 and workpiece"; empty where it is free
  double beyond =
      0;  ///< rad: from `own` to the nearest pose on its branch that is known to be free; 0: none is
  std::optional<ForbiddenPose> forbidden;  ///< the stiffest of all
  FollowedStretch stretch;                 ///< of `free`, where that is not the path's pose
  /// Where the tool's lean was chosen too: lead and tilt of the path, rad. Then `own` and `free` may lean
  /// otherwise, and neither `beyond` nor `stretch` is known.
  std::optional<std::array<double, 2>> lean;
};

/// One sentence each, the pose first.
std::vector<std::string> ReasonSentences(const PoseReason& reason);

}  // namespace millpose
