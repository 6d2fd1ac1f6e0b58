// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/mechanism.hpp"

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

ExternalPosition Mechanism::Home() const {
  ExternalPosition home;
  for (const ExternalAxis& axis : axes_) home.push_back(axis.home);
  return home;
}

Pose Mechanism::Moved(Carries carried, const ExternalPosition& position) const {
  assert(position.size() == axes_.size());
  Pose moved = Pose::Identity();
  for (size_t i = 0; i < axes_.size(); ++i)
    if (axes_[i].carries == carried) moved = moved * MotionOf(axes_[i], position[i]);
  return moved;
}

Pose Mechanism::MovedWith(size_t axis, const ExternalPosition& position) const {
  assert(position.size() == axes_.size() && axis < axes_.size());
  Pose moved = Pose::Identity();
  for (size_t i = 0; i <= axis; ++i)
    if (axes_[i].carries == axes_[axis].carries) moved = moved * MotionOf(axes_[i], position[i]);
  return moved;
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> Mechanism::LineOf(size_t axis,
                                                              const ExternalPosition& position) const {
  // An axis does not move by its own value: a rotary one stays where it is, a linear one moves along itself.
  const Pose moved = MovedWith(axis, position);
  return {moved.linear() * axes_[axis].direction, moved * axes_[axis].origin};
}

}  // namespace millpose
