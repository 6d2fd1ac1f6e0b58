// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace millpose {

/// {xyz_mm, abc_deg}: R = Rz(A)·Ry(B)·Rx(C), as KUKA counts.
struct PoseSettings {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mm
  Eigen::Vector3d abc = Eigen::Vector3d::Zero();       ///< rad
};

}  // namespace millpose
