// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace millpose {

/// A circle about an axis.
struct CircleFit {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< as high along the axis as the points' mean
  double radius = 0;
  double residual = 0;    ///< largest difference of a point's distance from the axis and the radius
  double widest_gap = 0;  ///< largest angle between neighbouring points, rad
};

/// The least-squares circle of points seen along `axis` (Kåsa 1976: least sum of (|p − c|² − r²)²). Empty for
/// fewer than three points, or when they lie on a line.
std::optional<CircleFit> FitCircle(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& axis);

}  // namespace millpose
