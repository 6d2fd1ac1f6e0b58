// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/lean_surface.hpp"

#include "toolpath/deepest_gouge.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/strategies/stepover.hpp"

namespace millpose {

LeanSurface::LeanSurface(Mesh mesh, CornerNormals normals, const Eigen::Isometry3d& X_WP,
                         const CutterShape& cutter, double tolerance)
    : mesh_(std::move(mesh)),
      normals_(std::move(normals)),
      X_PW_(X_WP.inverse()),
      cutter_(cutter),
      tolerance_(tolerance) {}

LeanSurface LeanSurface::At(const Eigen::Isometry3d& X_WP) const {
  LeanSurface moved = *this;
  moved.X_PW_ = X_WP.inverse();
  return moved;
}

double LeanSurface::Bend(const Eigen::Vector3d& contact, const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& feed) const {
  const SurfacePoint at = mesh_.Closest(X_PW_ * contact);
  return Curvature(mesh_, normals_, at.face, X_PW_.linear() * normal.cross(feed));
}

double LeanSurface::Gouge(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const {
  return DeepestGouge(mesh_, cutter_, X_PW_ * tip, X_PW_.linear() * axis, tolerance_).depth;
}

double LeanSurface::GougeBetween(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis,
                                 const Eigen::Vector3d& to_tip, const Eigen::Vector3d& to_axis) const {
  const int steps = GougeSteps(cutter_, (to_tip - tip).norm());
  double deepest = 0;
  for (int i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const Eigen::Vector3d between = axis + share * (to_axis - axis);
    deepest = std::max(deepest, Gouge(tip + share * (to_tip - tip), between.normalized()));
  }
  return deepest;
}

}  // namespace millpose
