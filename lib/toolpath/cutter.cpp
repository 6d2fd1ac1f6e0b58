// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cutter.hpp"

namespace millpose {
namespace {

constexpr double kUpright = 1e-9;  // sine of the angle between axis and normal

// The unit vector along the normal's part across the axis; 0 where there is none.
Eigen::Vector3d TowardNormal(const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = normal - normal.dot(axis) * axis;
  return across.norm() > kUpright ? Eigen::Vector3d(across.normalized()) : Eigen::Vector3d::Zero();
}

}  // namespace

Eigen::Vector3d TipAtContact(const CutterShape& cutter, const Eigen::Vector3d& contact,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const double r = cutter.corner_radius;
  const Eigen::Vector3d tip = contact + r * (normal - axis);
  return cutter.IsBall() ? tip : tip + (cutter.radius - r) * TowardNormal(normal, axis);
}

Eigen::Vector3d ContactAtTip(const CutterShape& cutter, const Eigen::Vector3d& tip,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const double r = cutter.corner_radius;
  return tip - r * (normal - axis) - (cutter.radius - r) * TowardNormal(normal, axis);
}

double ContactRadius(const CutterShape& cutter, const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const double sine = normal.cross(axis).norm(), r = cutter.corner_radius;
  return sine > kUpright ? cutter.radius - r + r * sine : 0;
}

}  // namespace millpose
