// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/pose_line.hpp"

#include "base/trig.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PoseLine::PoseLine(const Pose& from, const Pose& to)
    : from_(from.translation()), to_(to.translation()), R_(from.linear()) {
  Eigen::Quaterniond turn(Matrix3d(from.linear().transpose() * to.linear()));
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();  // of half the angle; half a turn has 1
  rotation_ = sine > 1e-12 ? Vector3d(turn.vec() * (2 * Atan2(sine, turn.w()) / sine)) : Vector3d::Zero();
}

Pose PoseLine::At(double share) const {
  Pose pose = Pose::Identity();
  pose.translation() = from_ + share * (to_ - from_);
  pose.linear() = R_;
  const double angle = rotation_.norm() * share;
  if (angle > 0) {
    const Vector3d axis = rotation_.normalized();
    Matrix3d cross;
    cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
    const SineCosine t = SinCos(angle);
    pose.linear() = R_ * (Matrix3d::Identity() + t.sin * cross + (1 - t.cos) * cross * cross);
  }
  return pose;
}

}  // namespace millpose
