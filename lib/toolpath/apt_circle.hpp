// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// A circle of CLDATA that the next motion follows. Lengths mm. The standard's circle has no direction of its
/// own: each system says in its own way which way round the tool goes (docs/cam-import.md).
struct AptCircle {
  Eigen::Vector3d centre;
  std::optional<Eigen::Vector3d> axis;     ///< unit vector; without it the tangent spans the plane
  bool clockwise = false;                  ///< the turn is clockwise about the axis (NX), else not told by it
  std::optional<Eigen::Vector3d> tangent;  ///< direction in which the tool leaves the start (INDIRV)
  std::optional<double> radius;            ///< as stated
  int full_turns = 0;                      ///< besides the part from start to end (NX: TIMES)
  Place place;
};

/// Points after `from` up to and with `to` on the circle, chords deviating by at most `tolerance` (mm).
/// `arriving` is the motion before (zero when there is none); it decides between the two ways of half and
/// full turns where nothing else does. Throws InputError at the circle's place when the ends do not lie on
/// it, when its radius is above 1e6 mm, and when nothing tells the direction.
std::vector<Eigen::Vector3d> CirclePoints(const AptCircle& circle, const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to, const Eigen::Vector3d& arriving,
                                          double tolerance);

}  // namespace millpose
