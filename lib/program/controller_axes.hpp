// SPDX-License-Identifier: GPL-3.0-or-later
// What controllers count with: orientation angles, axis angles, status and turn.
#pragma once

#include <optional>

#include "base/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/post.hpp"

namespace millpose {

/// Angles A, B, C (rad) of R as SINUMERIK and LinuxCNC count: rpy R = Rz(C)·Ry(B)·Rx(A), rpy2
/// R = Rx(A)·Ry(B)·Rz(C), euler R = Rz(A)·Rx(B)·Rz(C).
Eigen::Vector3d ToolAngles(AngleOrder rotation, const Eigen::Matrix3d& R);
Eigen::Matrix3d FromToolAngles(AngleOrder rotation, const Eigen::Vector3d& abc);
/// Of all A, B, C that give R the nearest to `near`, full revolutions included: what a control that runs the
/// three angles evenly must be told. Where only the sum or difference of two is determined, the one about Z
/// that turns outermost (of rpy2: innermost) stays.
Eigen::Vector3d ToolAnglesNear(AngleOrder rotation, const Eigen::Matrix3d& R, const Eigen::Vector3d& near);

/// rad (0.001°): nearer to 0 the controller's own arithmetic decides what a turn bit means, 0 or a full
/// revolution.
inline constexpr double kUncertainTurn = 1.7453293e-5;

/// Bit i−1 set where the controller's angle i is negative.
int ControllerTurn(const AxisConvention& axes, const Joints& q);

/// The joint angles at which the arm reaches flange pose X_BF on branch `status` with the controller's angles
/// signed as `turn` says, each within one full revolution (−360° ≤ negative < 0 ≤ positive < 360°); within
/// 1e-9 rad of 0, where the sign is noise, an angle is taken as 0 whatever `turn` says. Empty when the branch
/// does not reach the pose.
std::optional<Joints> AnglesAt(const Arm& arm, const AxisConvention& axes, const Pose& X_BF, int status,
                               int turn);

/// The controller's turn of a PTP target at the pose X_BF that the text states, which rounding has moved off
/// the planned angles `q` (a joint within the rounding of 0° would else be sent round by a full revolution).
int TurnAsWritten(const Arm& arm, const AxisConvention& axes, const Pose& X_BF, int status, const Joints& q);

/// `value` as Fixed(value, decimals) reads back.
double Rounded(double value, int decimals);

/// `number` with a fixed number of decimals; never "-0.000".
std::string Fixed(double number, int decimals);

/// The same without zeros at its end: 2076, 0.5.
std::string Short(double number, int decimals);

}  // namespace millpose
