// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// The part of a vector across `axis` (unit vector).
inline Eigen::Vector3d Across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - axis.dot(vector) * axis;
}

/// The angle of the right-hand turn about `axis` (unit vector) from `from` to `to`, with `full_turns` more:
/// above 0, a full revolution where both coincide within 1e-4 mm. Precondition: neither lies on the axis.
double ArcAngle(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& centre,
                const Eigen::Vector3d& axis, int full_turns);

/// Points after `from` up to and with `to` on the arc about `axis` (unit vector, right-hand turn) through
/// `centre`, after `full_turns` more; the part along the axis grows evenly (a helix). from = to is a full
/// turn. Chords deviate by at most `tolerance` (mm). Radii at both ends that differ are blended evenly.
/// Throws InputError at `place` when it becomes more than 1,000,000 points.
std::vector<Eigen::Vector3d> ArcPoints(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                                       int full_turns, double tolerance, const SourceLocation& place);

}  // namespace millpose
