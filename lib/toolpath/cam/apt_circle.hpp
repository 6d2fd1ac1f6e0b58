// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// A circle of CLDATA that the next motion follows. Lengths mm. Which way round the tool goes is said by each
/// system in its own way (docs/cam-import.md).
struct AptCircle {
  Eigen::Vector3d centre;
  std::optional<Eigen::Vector3d> axis;     ///< unit vector; without it the tangent spans the plane
  bool clockwise = false;                  ///< about the axis (NX), else counter-clockwise (SolidWorks CAM)
  std::optional<Eigen::Vector3d> tangent;  ///< direction in which the tool leaves the start (INDIRV)
  std::optional<double> radius;            ///< as stated
  std::optional<double> sweep;             ///< as stated (MOVARC), rad, right-handed about the axis
  int full_turns = 0;                      ///< besides the part from start to end (NX: TIMES)
  SourceLocation place;
};

/// A circle as chords.
struct AptArc {
  std::vector<Eigen::Vector3d> points;  ///< after the start
  Eigen::Vector3d leaving;              ///< the direction of motion at the end, any length
};

/// The circle from `from` to `to`, chords deviating by at most `tolerance` (mm). `arriving` is the direction
/// of the cut before (zero when there is none); `way` says whether it or the axis's sign decides. Throws
/// InputError at the circle's place when the ends do not lie on it, when its radius is above 1e6 mm, and when
/// direction and sign contradict.
AptArc FollowCircle(const AptCircle& circle, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const Eigen::Vector3d& arriving, CircleSense way, double tolerance);

}  // namespace millpose
