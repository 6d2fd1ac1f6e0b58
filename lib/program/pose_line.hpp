// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "robot/arm.hpp"

namespace millpose {

/// A straight motion of a frame: position on a line, orientation turning evenly about one axis, or by three
/// angles that run evenly.
class PoseLine {
 public:
  PoseLine(const Pose& from, const Pose& to);
  /// Orientation by angles (rad) from `first` to `last`: R = FromToolAngles(rotation, angles)·R_TCᵀ.
  PoseLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::string& rotation,
           const Eigen::Matrix3d& R_TC, const Eigen::Vector3d& first, const Eigen::Vector3d& last);

  Pose At(double share) const;                            ///< 0..1
  double length() const { return (to_ - from_).norm(); }  ///< mm
  double angle() const { return angle_; }                 ///< rad; of three angles a bound
  const Eigen::Vector3d& from() const { return from_; }
  const Eigen::Vector3d& to() const { return to_; }

 private:
  struct ByAngles {
    std::string rotation;
    Eigen::Matrix3d R_CT;
    Eigen::Vector3d first, last;
  };

  Eigen::Vector3d from_, to_;
  Eigen::Matrix3d R_ = Eigen::Matrix3d::Identity();  // at the start
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();  // unit, in the frame's start
  double angle_ = 0;
  std::optional<ByAngles> by_angles_;
};

}  // namespace millpose
