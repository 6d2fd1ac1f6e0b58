// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// Normals of the surface that a mesh's vertices lie on, where those of its facets are off by up to half of
/// the angle between two of them: at borders, which have facets on one side alone. A paraboloid is fitted
/// (least squares) to the vertices of the faces around, reached without passing a crease (rad) or leaving the
/// set or, in a STEP part, the face of the solid. So vertices that lie on a cylinder of 1,500 mm radius 15 mm
/// apart give its normal to 1e-4 degrees.
class FittedNormals {
 public:
  FittedNormals(const Mesh& mesh, std::function<bool(int face)> has_face, double crease);

  /// The unit normal at a point of a face; `rough`, that of the facets, where no paraboloid fits: the
  /// vertices are too few, or scatter about it by more than a tenth of their distances from the plane.
  Eigen::Vector3d At(const Eigen::Vector3d& p, int face, const Eigen::Vector3d& rough) const;

 private:
  struct Around;
  Around Gather(int face) const;

  Mesh mesh_;
  std::function<bool(int face)> has_face_;
  double crease_;
};

}  // namespace millpose
