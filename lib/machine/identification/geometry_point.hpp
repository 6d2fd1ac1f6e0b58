// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point of the flange stands and what moves it. Internal to geometry_fit and geometry_predict.
#pragma once

#include "machine/identification/geometry_fit.hpp"

namespace millpose {
namespace geometry_fit {

inline constexpr Eigen::Index kOfBase = 6, kOfReflector = 3, kOfFrame = 6, kFrames = 5;
/// Of the 30 numbers of frames 1 to 5 those that are looked for: shift along and turn about joint 1's axis
/// are the base's, along and about joint 6's the reflectors'.
inline constexpr std::array<Eigen::Index, 26> kLookedFor = {
    0, 1, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 25, 26, 28, 29};
inline constexpr auto kCount = static_cast<Eigen::Index>(kLookedFor.size());

inline Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The rigid motion that takes `from` to `to` with the least squares (Arun, Huang, Blostein 1987).
Pose Aligned(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to);

}  // namespace geometry_fit

/// A point of the flange of the arm as it is, in B, and what moves it.
struct GeometryFit::Pointed {
  Eigen::Vector3d place;
  Eigen::Matrix3d by_reflector;                              ///< per mm of the point in F
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_couplings;     ///< per factor
  Eigen::Matrix<double, 3, geometry_fit::kCount> by_frames;  ///< per mm and rad of what is looked for
};

}  // namespace millpose
