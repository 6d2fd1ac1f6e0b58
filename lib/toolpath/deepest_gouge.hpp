// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/cutter.hpp"

namespace millpose {

/// Where a cutter goes deepest into a part.
struct Gouge {
  double depth = 0;  ///< of a point of the surface in the cutter, from the cutter's own surface, mm; 0: none
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  int face = -1;
};

/// The point of the mesh's surface that lies deepest in the cutter, up to its length; depths of at most
/// `tolerance` (mm) count as none. The cutter is convex, so the depth is concave over a triangle: a tangent
/// plane of it bounds it from above, and triangles are halved until the bound is met (to 1e-4 mm or 0.1 % of
/// the depth). docs/gouges.md.
Gouge DeepestGouge(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
                   const Eigen::Vector3d& axis, double tolerance);

/// Whether any point of the surface lies deeper than `tolerance` in the cutter.
bool Gouges(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
            const Eigen::Vector3d& axis, double tolerance);

}  // namespace millpose
