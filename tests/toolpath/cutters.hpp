// SPDX-License-Identifier: GPL-3.0-or-later
// Cutters of the three kinds, and how they lean.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "toolpath/cutter.hpp"

namespace millpose {

inline constexpr std::array<CutterShape, 3> kCutters{{{10, 0, 40}, {10, 10, 40}, {10, 3, 40}}};

/// Tool axis over a surface normal along z, feed along x. Angles in rad.
inline Eigen::Vector3d Leaning(double lead, double tilt) {
  return Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(lead, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
}

}  // namespace millpose
