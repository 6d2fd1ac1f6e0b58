// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>

namespace millpose {

/// Barycentric weights of the point of triangle abc that is nearest to p (Ericson, Real-Time Collision
/// Detection, 5.1.5: by the Voronoi region of p).
Eigen::Vector3d ClosestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// Parameter 0..1 of the point of segment ab that is nearest to p.
double ClosestOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Whether the ray from `origin` along `direction` crosses triangle abc (Möller and Trumbore 1997).
bool RayCrosses(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& a,
                const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace millpose
