// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace millpose {

/// Axis times angle (rad, 0..π) of a rotation, in the frame that it is given in; 0 below 1e-12. At π one of
/// the two that say the same.
Eigen::Vector3d RotationVector(const Eigen::Matrix3d& rotation);

/// The rotation about `vector` by its length (rad).
Eigen::Matrix3d FromRotationVector(const Eigen::Vector3d& vector);

}  // namespace millpose
