// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "robot/arm.hpp"

namespace millpose {

/// A straight motion of a frame: position on a line, orientation turning evenly about one axis.
class PoseLine {
 public:
  PoseLine(const Pose& from, const Pose& to);
  Pose At(double share) const;                            ///< 0..1
  double length() const { return (to_ - from_).norm(); }  ///< mm
  double angle() const { return rotation_.norm(); }       ///< rad
  const Eigen::Vector3d& from() const { return from_; }
  const Eigen::Vector3d& to() const { return to_; }

 private:
  Eigen::Vector3d from_, to_;
  Eigen::Matrix3d R_;
  Eigen::Vector3d rotation_;  // axis times angle, in the frame's start
};

}  // namespace millpose
