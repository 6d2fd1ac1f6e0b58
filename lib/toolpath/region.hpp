// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/units.hpp"
#include "geometry/mesh/mesh.hpp"
#include "toolpath/region_borders.hpp"

namespace millpose {

class RegionTerm;

struct RegionBox {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();
};

/// What lies on the side of a plane that its normal points to.
struct HalfSpace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit vector
};

/// What lies in a polygon that is projected along a direction.
struct ProjectedPolygon {
  std::vector<Eigen::Vector3d> points;                   ///< three or more, in order, either way round
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector
};

/// The faces that are reached from the one nearest to a seed point over edges that bend by at most `crease`
/// (rad).
struct ConnectedFaces {
  Eigen::Vector3d seed = Eigen::Vector3d::Zero();
  double crease = DegToRad(20);
};

/// What of a part is milled. Everything that is given must hold; an empty one holds everywhere. Frame P, mm,
/// rad.
struct RegionOptions {
  std::optional<RegionBox> box;
  std::optional<HalfSpace> half_space;
  std::optional<ProjectedPolygon> polygon;
  std::optional<Eigen::Vector3d> facing;  ///< unit direction: only faces whose normal is near it
  double facing_within = DegToRad(45);    ///< the largest angle between normal and `facing`
  std::optional<ConnectedFaces> connected;
  /// Faces of the solid model that the triangles come from (STEP), each by number, "#id" or name; any when
  /// empty.
  std::vector<std::string> source_faces;
  std::vector<RegionOptions> all;   ///< all of these must hold
  std::vector<RegionOptions> any;   ///< at least one of these must hold, when there are some
  std::vector<RegionOptions> none;  ///< none of these may hold
  /// Kept from open rims and from edges to faces that are out of this set of conditions as a whole (facing,
  /// connected).
  double rim_distance = 0;
};

/// RegionOptions applied to a mesh: faces are in or out as a whole (facing, connected), points by a margin.
class Region {
 public:
  /// Throws InputError for polygons without area.
  Region(const Mesh& mesh, const RegionOptions& options);

  /// Whether any point of the face can be in.
  bool HasFace(int face) const { return has_face_[face] != 0; }
  /// How far a point p of a face lies inside, mm on the face (±1e9 where a plane limit runs along it);
  /// negative outside. On one face it changes by at most 1 mm per mm (so between two points it cannot pass 0
  /// unseen).
  double Margin(int face, const Eigen::Vector3d& p) const;

  /// The part of one of the region's faces within its outermost box and half-space, a convex polygon.
  struct Patch {
    int face = -1;
    std::vector<Eigen::Vector3d> corners;
  };
  /// All of them, for extents.
  std::vector<Patch> Patches() const;
  /// Whether there is any rim or edge to a face that is out as a whole.
  bool HasBorders() const { return !borders_.empty(); }
  /// Distance of p from the nearest of them, mm; infinite when there is none.
  double BorderDistance(const Eigen::Vector3d& p) const { return borders_.Distance(p); }
  /// Sum of the region's face normals weighted with area, as a unit vector; zero when they cancel out.
  Eigen::Vector3d MeanNormal() const;
  const Mesh& mesh() const { return mesh_; }

 private:
  Mesh mesh_;
  RegionOptions options_;
  std::shared_ptr<const RegionTerm> term_;
  std::vector<char> has_face_;
  RegionBorders borders_;
};

}  // namespace millpose
