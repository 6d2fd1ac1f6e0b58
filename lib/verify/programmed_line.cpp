// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/programmed_line.hpp"

#include "program/controller_axes.hpp"

namespace millpose {

ProgrammedLine::ProgrammedLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                               const std::string& rotation, const Eigen::Matrix3d& R_TC,
                               const Eigen::Vector3d& first, const Eigen::Vector3d& last)
    : line_(Pose(Eigen::Translation3d(from)), Pose(Eigen::Translation3d(to))),
      by_angles_(ByAngles{rotation, R_TC.transpose(), first, last}) {}

Pose ProgrammedLine::At(double share) const {
  Pose pose = line_.At(share);
  if (!by_angles_) return pose;
  const Eigen::Vector3d angles = by_angles_->first + share * (by_angles_->last - by_angles_->first);
  pose.linear() = FromToolAngles(by_angles_->rotation, angles) * by_angles_->R_CT;
  return pose;
}

double ProgrammedLine::angle() const {
  return by_angles_ ? (by_angles_->last - by_angles_->first).cwiseAbs().sum() : line_.angle();
}

}  // namespace millpose
