// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/kinematics.hpp"

namespace millpose {

/// Parts of a motion in which no joint turns by more than this share of the tube about it are divided no
/// further.
inline constexpr double kSmallBesideTube = 0.05;

/// The six joint axes at one pose of the arm: points on them and unit directions, in the world.
struct JointAxes {
  std::array<Eigen::Vector3d, 6> point, direction;
};

/// Axes of joints 1..6 from the link frames in W (kinematics.hpp, LinkFrames, times X_WB).
JointAxes AxesOf(const LinkPoses& X_WL);

/// Bounds of how far a rigid body moves when each joint turns by at most `turn` (rad, ≥ 0) from a pose.
/// Entry j (0..6): bound of the displacement, mm, of any point of the body's box as seen from link j; entries
/// from the body's own link on are 0, entry 0 is the displacement in the world. The box is given by its
/// centre and half axes in W at that pose.
///
/// A point at distance r from axis j moves by at most r·turn_j about it. Joints beyond j have by then moved
/// the point by at most m_j, so its distance has grown to at most r + m_j, hence m_{j−1} = m_j + turn_j (r +
/// m_j).
std::array<double, 7> MotionBounds(const JointAxes& axes, int link, const Eigen::Vector3d& centre,
                                   const Eigen::Matrix3d& half_axes, const Joints& turn);

/// No less than entry 0 of that, from the ball about the box alone, which costs less: of any point within
/// `radius` of `centre`.
double BallMoves(const JointAxes& axes, int link, const Eigen::Vector3d& centre, double radius,
                 const Joints& turn);

}  // namespace millpose
