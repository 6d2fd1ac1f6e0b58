// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/conventions.hpp"

namespace millpose {

Eigen::Vector3d DirectionOf(FrameAxis axis) {
  const int number = static_cast<int>(axis);
  const Eigen::Vector3d direction = Eigen::Vector3d::Unit(number % 3);
  return number < 3 ? direction : Eigen::Vector3d(-direction);
}

Eigen::Matrix3d ToolAxis(FrameAxis axis) {
  // Columns: the axes of C in T. With C's axis number k along T's z, the next axes follow T's x and y.
  const int k = static_cast<int>(axis) % 3;
  Eigen::Matrix3d R_TC = Eigen::Matrix3d::Zero();
  R_TC.col(k) = Eigen::Vector3d::UnitZ();
  R_TC.col((k + 1) % 3) = Eigen::Vector3d::UnitX();
  R_TC.col((k + 2) % 3) = Eigen::Vector3d::UnitY();
  if (axis < FrameAxis::kMinusX) return R_TC;
  // Half a turn about the axis that follows.
  R_TC.col(k) *= -1;
  R_TC.col((k + 2) % 3) *= -1;
  return R_TC;
}

}  // namespace millpose
