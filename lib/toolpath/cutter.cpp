// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cutter.hpp"

namespace millpose {

Eigen::Vector3d TipAtContact(const CutterShape& cutter, const Eigen::Vector3d& contact,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = normal - normal.dot(axis) * axis;
  const double r = cutter.corner_radius;
  Eigen::Vector3d tip = contact + r * (normal - axis);
  if (across.norm() > 1e-9) tip += (cutter.radius - r) * across.normalized();
  return tip;
}

}  // namespace millpose
