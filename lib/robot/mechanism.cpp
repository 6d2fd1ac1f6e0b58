// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/mechanism.hpp"

#include <cassert>

#include "base/trig.hpp"

namespace millpose {
namespace {

/// Rodrigues' formula, by trigonometry of our own.
Eigen::Matrix3d Turned(const Eigen::Vector3d& axis, double angle) {
  const auto [sine, cosine] = SinCos(angle);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return cosine * Eigen::Matrix3d::Identity() + sine * cross + (1 - cosine) * axis * axis.transpose();
}

/// One axis alone, with all others at 0.
Pose MotionOf(const ExternalAxis& axis, double value) {
  Pose motion = Pose::Identity();
  if (axis.kind == AxisKind::kLinear) {
    motion.translation() = value * axis.direction;
  } else {
    motion.linear() = Turned(axis.direction, value);
    motion.translation() = axis.origin - motion.linear() * axis.origin;
  }
  return motion;
}

}  // namespace

Pose Mechanism::Moved(Carries carried, const ExternalPosition& position) const {
  assert(position.size() == axes_.size());
  Pose moved = Pose::Identity();
  for (size_t i = 0; i < axes_.size(); ++i)
    if (axes_[i].carries == carried) moved = moved * MotionOf(axes_[i], position[i]);
  return moved;
}

Eigen::Matrix3d Mechanism::Compliance(const ExternalPosition& position, const Eigen::Vector3d& tip) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Carries carried : {Carries::kRobot, Carries::kWorkpiece}) {
    Pose before = Pose::Identity();
    for (size_t i = 0; i < axes_.size(); ++i) {
      const ExternalAxis& axis = axes_[i];
      if (axis.carries != carried) continue;
      const Eigen::Vector3d direction = before.linear() * axis.direction;
      const Eigen::Vector3d moved =
          axis.kind == AxisKind::kLinear ? direction : direction.cross(tip - before * axis.origin).eval();
      sum += axis.compliance.value_or(0) * moved * moved.transpose();
      before = before * MotionOf(axis, position[i]);
    }
  }
  return sum;
}

}  // namespace millpose
