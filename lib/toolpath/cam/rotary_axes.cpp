// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/rotary_axes.hpp"

#include <algorithm>

#include "base/trig.hpp"

namespace millpose {
namespace {

// Rodrigues' formula, with sines that are the same on every machine.
Eigen::Matrix3d Turn(const Eigen::Vector3d& axis, double angle) {
  const SineCosine turn = SinCos(angle);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return turn.cos * Eigen::Matrix3d::Identity() + turn.sin * cross + (1 - turn.cos) * axis * axis.transpose();
}

}  // namespace

bool RotaryAxes::Has(char letter) const {
  return std::ranges::any_of(axes_, [&](const RotaryAxis& axis) { return axis.letter == letter; });
}

Eigen::Isometry3d RotaryAxes::Chain(const std::array<double, 3>& angles, bool workpiece) const {
  Eigen::Isometry3d chain = Eigen::Isometry3d::Identity();
  for (const RotaryAxis& axis : axes_) {
    if (axis.carries_workpiece != workpiece) continue;
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    step.linear() = Turn(axis.direction, angles[static_cast<size_t>(axis.letter - 'A')]);
    step.translation() = axis.point - step.linear() * axis.point;
    chain = chain * step;
  }
  return chain;
}

Eigen::Vector3d RotaryAxes::ToolAxis(const std::array<double, 3>& angles) const {
  return (Chain(angles, true).linear().transpose() * Chain(angles, false).linear().col(2)).normalized();
}

Eigen::Vector3d RotaryAxes::Tip(const Eigen::Vector3d& machine, const std::array<double, 3>& angles) const {
  return Chain(angles, true).inverse() * (machine + Chain(angles, false).translation());
}

Eigen::Vector3d RotaryAxes::Machine(const Eigen::Vector3d& tip, const std::array<double, 3>& angles) const {
  return Chain(angles, true) * tip - Chain(angles, false).translation();
}

double RotaryAxes::Lever(const Eigen::Vector3d& machine) const {
  double lever = 0;
  for (const RotaryAxis& axis : axes_)
    lever = std::max(lever, axis.carries_workpiece ? (machine - axis.point).norm() : axis.point.norm());
  return lever;
}

}  // namespace millpose
