// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// Points after `from` up to and with `to` on the arc about `axis` (unit vector, right-hand turn) through
/// `centre`, after `full_turns` more; the part along the axis grows evenly (a helix). from = to is a full
/// turn. Chords deviate by at most `tolerance` (mm). Radii at both ends that differ are blended evenly.
/// Throws InputError at `place` when it becomes more than 1,000,000 points.
std::vector<Eigen::Vector3d> ArcPoints(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                                       int full_turns, double tolerance, const Place& place);

}  // namespace millpose
