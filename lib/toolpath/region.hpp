// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/units.hpp"
#include "surface/bvh.hpp"
#include "surface/mesh.hpp"

namespace millpose {

/// What of a part is milled. Everything that is given must hold. Frame P, mm, rad.
struct RegionOptions {
  std::optional<std::array<Eigen::Vector3d, 2>> box;  ///< lower and upper corner
  std::optional<Eigen::Vector3d> facing;              ///< unit direction: only faces whose normal is near it
  double facing_within = DegToRad(45);                ///< the largest angle between normal and `facing`
  double rim_distance = 0;  ///< kept from open rims and from the edges to faces that `facing` leaves out
};

/// RegionOptions applied to a mesh: faces are in or out as a whole (facing), points by a margin.
class Region {
 public:
  Region(const Mesh& mesh, const RegionOptions& options);

  bool HasFace(int face) const { return has_face_[face] != 0; }
  /// How far p lies inside the box and away from rims and borders beyond the wanted distance, mm; negative
  /// outside. Changes by at most 1 mm per mm (so between two points it cannot pass 0 unseen).
  double Margin(const Eigen::Vector3d& p) const;

  /// The parts of the region's faces that lie in the box, as convex polygons (for extents).
  std::vector<std::vector<Eigen::Vector3d>> Patches() const;
  /// Sum of the region's face normals weighted with area, as a unit vector; zero when they cancel out.
  Eigen::Vector3d MeanNormal() const;

 private:
  Mesh mesh_;
  RegionOptions options_;
  std::vector<char> has_face_;
  std::vector<std::array<Eigen::Vector3d, 2>> borders_;  // rims and edges to faces that are out
  Bvh border_tree_;
};

}  // namespace millpose
