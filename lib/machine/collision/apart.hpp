// SPDX-License-Identifier: GPL-3.0-or-later
// How far a convex body is from a mesh or another at least, and at most: proven by planes between them and by
// points of both, far cheaper than the distance.
#pragma once

#include "machine/collision/cell.hpp"
#include "machine/collision/triangle_tree.hpp"

namespace millpose {

/// A convex body as what bounds it: a box, and a cylinder about the box's z axis where the shape is round.
struct Envelope {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the box, mm, shape frame
  Eigen::Vector3d half = Eigen::Vector3d::Zero();    ///< its half sizes, mm
  double radius = 0;  ///< of the cylinder, mm, about the line through the centre along z; 0: none
  /// What the body is: for all but kHull the nearest point to any other is known in closed form.
  enum class Kind : uint8_t { kHull, kBox, kCylinder, kRounded };
  Kind kind = Kind::kHull;
  double core = 0;  ///< of kRounded (sphere, capsule): half the length of its segment along z, mm
};

/// The envelope of a convex shape (anything but Triangles) whose bounding box is given, mm.
Envelope EnvelopeOf(const Shape& shape, const Eigen::Vector3d& centre, const Eigen::Vector3d& half);

/// A lower bound, mm, of the distance between the body and every triangle of the mesh: never more than the
/// true distance, at most `bound`; 0 or more. The search ends as soon as it has fallen below `enough`: what
/// is returned then is below `enough`, and still a lower bound. `X_MG`: the body's frame in the mesh's. Only
/// surfaces count: a body wholly inside a closed mesh is as far from it as from its skin.
double LeastDistance(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh, double bound,
                     double enough);

/// What is certain of a distance, mm: least ≤ distance ≤ most.
struct DistanceBracket {
  double least, most;
};

/// Brackets the distance between the body (not kHull) and the triangles of the mesh by points of both and
/// planes between them, at a fraction of the cost of the distance; `least` is at most `bound`, `most` is
/// infinite where nothing so near was found. Ends as soon as `most` has fallen below `near`: then `least` is
/// 0. Only surfaces count.
DistanceBracket BracketDistance(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh,
                                double bound, double near);

/// Likewise of two bodies (not kHull), by a few points and planes; `X_AB`: b's frame in a's. They may touch
/// where `least` is 0.
DistanceBracket BracketDistance(const Envelope& a, const Pose& X_AB, const Envelope& b);

}  // namespace millpose
