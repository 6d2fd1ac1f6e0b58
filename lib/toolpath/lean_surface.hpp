// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/corner_normals.hpp"
#include "toolpath/cutter.hpp"

namespace millpose {

/// The part under a cutter that may lean. Places, directions and axes in W; mm, 1/mm. Immutable.
class LeanSurface {
 public:
  /// `tolerance`: depth of the cutter in the part that is allowed; `normals` of the mesh.
  LeanSurface(Mesh mesh, CornerNormals normals, const Eigen::Isometry3d& X_WP, const CutterShape& cutter,
              double tolerance);

  /// By how much the surface bends across the feed at a contact, positive where it is convex.
  double Bend(const Eigen::Vector3d& contact, const Eigen::Vector3d& normal,
              const Eigen::Vector3d& feed) const;
  /// How deep the cutter goes into the part; 0 up to the tolerance.
  double Gouge(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const;
  /// The deepest on the straight way between two stances, tip and axis moving evenly; the ends are not looked
  /// at.
  double GougeBetween(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, const Eigen::Vector3d& to_tip,
                      const Eigen::Vector3d& to_axis) const;

  /// The same of a part that stands elsewhere.
  LeanSurface At(const Eigen::Isometry3d& X_WP) const;

  double tolerance() const { return tolerance_; }

 private:
  Mesh mesh_;
  CornerNormals normals_;
  Eigen::Isometry3d X_PW_;
  CutterShape cutter_;
  double tolerance_;
};

}  // namespace millpose
