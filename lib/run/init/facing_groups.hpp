// SPDX-License-Identifier: GPL-3.0-or-later
// What of a part a first job could mill: stretches of its surface that one direction of the tool reaches.
#pragma once

#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

inline constexpr double kGroupCreaseDeg = 20;   ///< curved groups end at edges that bend more sharply
inline constexpr double kFlatWithinDeg = 1;     ///< normals of a flat group about its direction
inline constexpr double kCurvedWithinDeg = 30;  ///< of any other
inline constexpr double kFlatCreaseDeg = 1;     ///< so do flat ones

/// Faces that hang together without a crease and face one way. Frame P, mm.
struct FacingGroup {
  Eigen::Vector3d seed = Eigen::Vector3d::Zero();        ///< on the surface, near the group's middle
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit; out of the material
  bool flat = false;                                     ///< a plane
  double crease_deg = kGroupCreaseDeg;                   ///< that it ends at
  double area = 0;                                       ///< mm², of what faces that way
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< bounds of that
};

/// The largest groups of a mesh, `most` of them at most. Plane ones count three times their area: a first job
/// is surest there.
std::vector<FacingGroup> FindFacingGroups(const Mesh& mesh, size_t most);

}  // namespace millpose
