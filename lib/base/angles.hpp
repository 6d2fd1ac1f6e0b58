// SPDX-License-Identifier: GPL-3.0-or-later
// Rotations as three angles about axes that turn along, the same bits on every machine.
#pragma once

#include <Eigen/Core>

namespace millpose {

/// Rotation by `angle` (rad) about the axis x (0), y (1) or z (2).
Eigen::Matrix3d RotationAbout(int axis, double angle);

/// Three angles (rad) of R = Rz(v0)·Ry(v1)·Rx(v2): KUKA's A, B, C, and SINUMERIK's C, B, A by RPY. v1 lies in
/// [−π/2, π/2]; where |v1| = π/2 only v0 ∓ v2 is determined and v0 is set to 0. The third angle is taken
/// from what the first leaves over, so that the three together are exact near that place too.
Eigen::Vector3d AnglesZyx(const Eigen::Matrix3d& R);
Eigen::Matrix3d FromAnglesZyx(const Eigen::Vector3d& angles);

/// Three angles (rad) of R = Rz(v0)·Rx(v1)·Rz(v2) (Euler): v1 in [0, π]; v0 = 0 where v1 is 0 or π.
Eigen::Vector3d AnglesZxz(const Eigen::Matrix3d& R);
Eigen::Matrix3d FromAnglesZxz(const Eigen::Vector3d& angles);

}  // namespace millpose
