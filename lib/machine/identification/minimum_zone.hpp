// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace millpose {

struct MinimumZone {
  double width = 0;        ///< mm
  Eigen::Vector3d normal;  ///< of the two planes; its largest component is positive
};

/// The two parallel planes nearest to each other that hold all points between them, in exact arithmetic on
/// the convex hull (CGAL's Width_3, after Gärtner and Herrmann). At least 4 points that are not all in one
/// plane.
MinimumZone FindMinimumZone(const std::vector<Eigen::Vector3d>& points);

/// Whether all points lie in one plane, exactly.
bool AreCoplanar(const std::vector<Eigen::Vector3d>& points);

}  // namespace millpose
