// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace millpose {

/// How flat measured points are.
struct Flatness {
  Eigen::Vector3d centre;         ///< centroid, a point of the least-squares plane, mm
  Eigen::Vector3d normal;         ///< of the least-squares plane; its largest component is positive
  std::vector<double> distances;  ///< signed, of every point from that plane, mm
  double flatness = 0;            ///< d_max − d_min of the distances, mm (Chen 2021 eq. 37)
  double rms = 0;                 ///< root mean square of the distances, mm
  double minimum_zone =
      0;  ///< least distance of two parallel planes that hold all points between them, mm (ISO 1101)
  Eigen::Vector3d zone_normal;   ///< of those planes
  std::vector<size_t> outliers;  ///< farther from the median distance than 3.5 robust standard deviations
};

/// Orthogonal least-squares plane by the singular values of the centred points, and the minimum zone exactly
/// (up to the last rounding). Empty when the points are fewer than 3 or lie on a line.
std::optional<Flatness> MeasureFlatness(const std::vector<Eigen::Vector3d>& points);

/// The same without the minimum zone, which takes far longer, and without outliers.
std::optional<Flatness> FitPlane(const std::vector<Eigen::Vector3d>& points);

}  // namespace millpose
