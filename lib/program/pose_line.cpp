// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/pose_line.hpp"

#include "base/trig.hpp"
#include "program/controller_axes.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PoseLine::PoseLine(const Pose& from, const Pose& to)
    : from_(from.translation()), to_(to.translation()), R_(from.linear()) {
  Eigen::Quaterniond turn(Matrix3d(from.linear().transpose() * to.linear()));
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();  // of half the angle; half a turn has 1
  if (sine <= 1e-12) return;
  axis_ = turn.vec() / sine;
  angle_ = 2 * Atan2(sine, turn.w());
}

PoseLine::PoseLine(const Vector3d& from, const Vector3d& to, const std::string& rotation,
                   const Matrix3d& R_TC, const Vector3d& first, const Vector3d& last)
    : from_(from),
      to_(to),
      angle_((last - first).cwiseAbs().sum()),
      by_angles_(ByAngles{rotation, R_TC.transpose(), first, last}) {}

Pose PoseLine::At(double share) const {
  Pose pose = Pose::Identity();
  pose.translation() = from_ + share * (to_ - from_);
  if (by_angles_) {
    const Vector3d angles = by_angles_->first + share * (by_angles_->last - by_angles_->first);
    pose.linear() = FromToolAngles(by_angles_->rotation, angles) * by_angles_->R_CT;
    return pose;
  }
  pose.linear() = R_;
  if (angle_ > 0) {
    Matrix3d cross;
    cross << 0, -axis_.z(), axis_.y(), axis_.z(), 0, -axis_.x(), -axis_.y(), axis_.x(), 0;
    const SineCosine t = SinCos(angle_ * share);
    pose.linear() = R_ * (Matrix3d::Identity() + t.sin * cross + (1 - t.cos) * cross * cross);
  }
  return pose;
}

}  // namespace millpose
