// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "base/trig.hpp"

namespace millpose {

/// Rotation by `angle` (rad) about the unit vector `axis` (Rodrigues' formula), the same bits on every
/// machine.
inline Eigen::Matrix3d RotationAbout(const Eigen::Vector3d& axis, double angle) {
  const SineCosine turn = SinCos(angle);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix3d::Identity() + turn.sin * cross + (1 - turn.cos) * cross * cross;
}

}  // namespace millpose
