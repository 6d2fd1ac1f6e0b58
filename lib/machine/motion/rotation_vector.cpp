// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/rotation_vector.hpp"

#include <Eigen/Geometry>

#include "base/rotation.hpp"

namespace millpose {
namespace {

constexpr double kNoVector = 1e-12;

}  // namespace

Eigen::Vector3d RotationVector(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond turn(rotation);
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();
  return sine > kNoVector ? Eigen::Vector3d(turn.vec() * (2 * Atan2(sine, turn.w()) / sine))
                          : Eigen::Vector3d::Zero();
}

Eigen::Matrix3d FromRotationVector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  return angle > kNoVector ? RotationAbout(vector / angle, angle) : Eigen::Matrix3d::Identity();
}

}  // namespace millpose
