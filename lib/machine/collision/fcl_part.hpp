// SPDX-License-Identifier: GPL-3.0-or-later
// The adapter to FCL: shapes as FCL geometry, and the bounded distance of two of them. Only cell/*.cpp
// include it.
#pragma once

#include <fcl/geometry/collision_geometry.h>

#include <array>
#include <memory>

#include "machine/collision/apart.hpp"
#include "machine/collision/solid.hpp"

namespace millpose {

/// One shape as FCL geometry, immutable and shared by all checkers.
struct FclPart {
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;
  Shape shape;                                         ///< kept for support points of the convex kinds
  std::shared_ptr<const Solid> solid;                  ///< of a mesh
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< of the bounding box, mm, shape frame
  Eigen::Vector3d half = Eigen::Vector3d::Zero();      ///< its half sizes, mm
  Eigen::Vector3d interior = Eigen::Vector3d::Zero();  ///< a point inside a convex shape
  double radius = 0;                                   ///< of the bounding sphere about `centre`, mm
  Envelope envelope;                                   ///< of a convex shape

  bool mesh() const { return solid != nullptr; }
};

/// What is wrong with a shape, empty when it can be built: sizes, finite numbers, indices, at least four
/// points that span a volume.
std::string ShapeProblem(const Shape& shape);

/// Builds the geometry of a shape without problems. A frustum becomes a polyhedron around it.
FclPart MakePart(const Shape& shape);

/// Where a part stands: its pose and its bounding box in W.
struct Placed {
  const FclPart* part = nullptr;
  Pose X_WG;
  Eigen::Vector3d centre;     ///< of the box, W, mm
  Eigen::Matrix3d half_axes;  ///< columns: half axes of the box, W, mm
};
Placed PlacePart(const FclPart& part, const Pose& X_WG);

/// A lower bound of the distance of two parts from their bounding spheres and boxes, mm; 0 when these
/// overlap.
double BoxDistance(const Placed& a, const Placed& b);

/// BoxDistance(a, b) >= bound, worked out only as far as needed.
bool BoxesApart(const Placed& a, const Placed& b, double bound);

/// BoxesApart by what takes directions from `still` alone: if it holds with a bound greater by √3 m, it holds
/// however `part`, or a point of its box, is moved by up to m.
bool ApartFromStill(const Placed& still, const Placed& part, double bound);

/// BoxesApart by what takes directions from `side` alone: if it holds with a bound greater by √3 m, it holds
/// however the other, as seen from `side`, is moved by up to m.
bool ApartAlongAxes(const Placed& side, const Placed& other, double bound);

/// A lower bound of the distance of two parts from planes between them, mm, at most `bound` (> 0): never more
/// than DistanceUpTo, at a fraction of its cost. Below `enough` nothing is proven but that it may be so near;
/// the search stops there. 0 for a part wholly inside a closed mesh. Of two meshes one is taken as its box.
double ProvenDistance(const Placed& a, const Placed& b, double bound, double enough);

/// What is certain of the distance of two parts, as BracketDistance; {0, infinite} where not one is a shape
/// whose nearest points are known in closed form and the other such a shape or a mesh. A part wholly inside a
/// closed mesh and farther than `bound` from its surface touches it.
DistanceBracket BracketOf(const Placed& a, const Placed& b, double bound, double near);

/// The distance of two parts as far as it was asked for.
struct BoundedDistance {
  double distance = 0;  ///< mm; at least the bound when they are not nearer than that; ≤ 0 when they touch
  /// Where each part is nearest to the other, W, when nearer than the bound; twice the same place between
  /// them where no more is known.
  std::array<Eigen::Vector3d, 2> ends{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Distance of two parts up to `bound` (> 0, mm). A part wholly inside a closed mesh touches it. Between
/// convex parts the answer never exceeds the true distance: it is a separation by two parallel planes.
/// Overlapping convex parts get minus the least overlap along the directions tried (an upper bound of the
/// depth).
BoundedDistance DistanceUpTo(const Placed& a, const Placed& b, double bound);

}  // namespace millpose
