// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace millpose {

/// A rigid motion and how well it fits.
struct PointFit {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  std::vector<double> residuals;  ///< |X from − to|, one a point, mm
  double rms = 0;                 ///< mm
  double largest = 0;             ///< mm
};

/// The rigid motion X (no mirror image, no scale) that brings `from` to `to` with the least sum of squared
/// distances (Kabsch 1976, by singular value decomposition). Empty when there are fewer than three points,
/// the numbers differ or the points lie (nearly) on a line: then the rotation about it is not known.
std::optional<PointFit> FitPoints(const std::vector<Eigen::Vector3d>& from,
                                  const std::vector<Eigen::Vector3d>& to);

}  // namespace millpose
