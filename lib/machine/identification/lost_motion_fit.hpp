// SPDX-License-Identifier: GPL-3.0-or-later
// Lost motion of joints from readings taken both ways (docs/lost-motion.md).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "machine/robot/kinematics.hpp"

namespace millpose {

/// Readings of one dial in one pose, of which one joint has come there from both sides, or the tool was
/// pushed both ways. Half the difference of the two means is half the gap's step at the dial.
struct TwoWayReading {
  int joint = 0;  ///< 0..5
  Joints q = Joints::Zero();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< that the dial touches, in F, mm
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< in which it counts, unit, in B
  /// mm. Approached: with the joint from below (smaller angles), from above. Pushed: against, along
  /// direction.
  std::vector<double> first, second;
  double push = 0;  ///< N, force along `direction` at the point, as much to either side; 0: approached
};

/// What readings say about the lost motion of one joint.
struct LostMotionEstimate {
  bool determined = false;
  std::string reason;                      ///< when not: why no number is given
  double width = 0, lower = 0, upper = 0;  ///< rad, at least 0; 95 % interval (Student's t)
  double half_difference = 0;              ///< mm, of the pose where it is largest
  size_t readings = 0, poses = 0;
};

/// Least squares of the differences D of second and first means over the dial's way per turn of the joint,
/// each weighed by its numbers of readings; their spread is that of single readings about their means and of
/// D about the fit. Of pushed readings what the arm yields, 2·push·dᵀcd, is taken out first. No number for a
/// joint without readings, with fewer than five, with none whose dial goes at least 50 mm per rad, or with
/// differences of the wrong sign.
std::array<LostMotionEstimate, 6> FitLostMotion(const Arm& arm, const std::vector<TwoWayReading>& readings);

}  // namespace millpose
