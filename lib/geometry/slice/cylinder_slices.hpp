// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>
#include <vector>

#include "geometry/slice/curve.hpp"

namespace millpose {

/// An axis: a point (mm) and a unit direction.
struct Axis {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();

  /// Distance of p from the axis, mm.
  double Radius(const Eigen::Vector3d& p) const { return direction.cross(p - point).norm(); }
};

/// Cuts a mesh with coaxial cylinders of the given radii (mm, > 0), triangle by triangle: a plane facet meets
/// a cylinder in arcs of an ellipse (lines where the facet is parallel to the axis). For each radius its
/// curves, with the axis on their left seen against the surface normal; closed where they close. Throws
/// Interrupted.
std::vector<std::vector<Curve>> SliceByCylinders(const Mesh& mesh, const Axis& axis,
                                                 const std::vector<double>& radii, std::stop_token stop);

}  // namespace millpose
