// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/probed_part.hpp"

#include <cmath>

#include "geometry/mesh/corner_normals.hpp"
#include "geometry/mesh/round_holes.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kHoleTolerance = 0.1;  // mm, by which the wall of a hole may be out of round
constexpr double kSameWay = 0.5;        // cosine of 60°

/// Two unit vectors across `axis` and each other.
std::array<Vector3d, 2> Across(const Vector3d& axis) {
  int least = 0;
  axis.cwiseAbs().minCoeff(&least);
  const Vector3d first = axis.cross(Vector3d::Unit(least)).normalized();
  return {first, axis.cross(first)};
}

ProbeEquations AcrossLine(const Vector3d& axis, const Vector3d& from, const Vector3d& p) {
  ProbeEquations found;
  for (const Vector3d& d : Across(axis)) found.Add(d, d.dot(p - from));
  return found;
}

}  // namespace

double ProbeEquations::Length() const {
  double squares = 0;
  for (int i = 0; i < count; ++i) squares += distance[i] * distance[i];
  return std::sqrt(squares);
}

void ProbeEquations::Add(const Vector3d& d, double mm) {
  direction[count] = d;
  distance[count] = mm;
  ++count;
}

ProbedPart::ProbedPart(const Mesh& mesh, double crease) : mesh_(mesh) {
  Eigen::AlignedBox3d all;
  std::vector<Eigen::AlignedBox3d> face_boxes, edge_boxes;
  for (int face = 0; face < mesh.face_count(); ++face) {
    Eigen::AlignedBox3d box;
    for (int k = 0; k < 3; ++k) box.extend(mesh.Corner(face, k));
    face_boxes.push_back(box);
    all.extend(box);
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(face, k);
      if (other >= 0 && (other < face || BendAngle(mesh, face, k) <= crease)) continue;
      edges_.push_back({mesh.Corner(face, k), mesh.Corner(face, (k + 1) % 3)});
      edge_boxes.emplace_back(edges_.back().from);
      edge_boxes.back().extend(edges_.back().to);
    }
  }
  faces_ = Bvh(face_boxes);
  edge_tree_ = Bvh(edge_boxes);
  for (const RoundHole& hole : FindRoundHoles(mesh, crease, kHoleTolerance))
    holes_.push_back({hole.entrance, hole.entrance + hole.axis});
  if (!all.isEmpty()) size_ = 0.5 * all.diagonal().norm();
}

ProbeEquations ProbedPart::Equations(const ProbedPoint& point, const Vector3d& p,
                                     const std::optional<Vector3d>& normal) const {
  if (point.on == ProbedOn::kFace) return OfFace(point, p, normal);
  if (point.on == ProbedOn::kEdge) return OfEdge(p);
  if (point.on == ProbedOn::kHole) return OfHole(p);
  ProbeEquations found;
  for (int axis = 0; axis < 3; ++axis)
    found.Add(Vector3d::Unit(axis), p[axis] - point.nominal.value_or(p)[axis]);
  return found;
}

ProbeEquations ProbedPart::OfFace(const ProbedPoint& point, const Vector3d& p,
                                  const std::optional<Vector3d>& normal) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  // A wall is thin: from where the part was thought to stand its other side may be nearer.
  const auto distance = [&](int face) {
    if (normal && mesh_.FaceNormal(face).dot(*normal) < kSameWay) return kFar;
    return (mesh_.ClosestOnFace(p, face).position - p).squaredNorm();
  };
  const int face = faces_.Nearest(p, kFar, distance).first;
  ProbeEquations found;
  if (face < 0) return found;
  const Vector3d away = p - mesh_.ClosestOnFace(p, face).position;
  const double length = away.norm();
  // A ball touches a rounded or sharp corner along the line from there to its centre, everything else along
  // the normal.
  const Vector3d& n = mesh_.FaceNormal(face);
  if (point.radius > 0 && n.dot(away) > kSameWay * length)
    found.Add(away / length, length - point.radius);
  else
    found.Add(n, n.dot(away) - point.radius);
  return found;
}

ProbeEquations ProbedPart::OfEdge(const Vector3d& p) const {
  const auto nearest = [&](int i) -> Vector3d {
    const Line& edge = edges_[i];
    return edge.from + ClosestOnSegment(p, edge.from, edge.to) * (edge.to - edge.from);
  };
  const int i = edge_tree_
                    .Nearest(p, std::numeric_limits<double>::infinity(),
                             [&](int k) { return (nearest(k) - p).squaredNorm(); })
                    .first;
  if (i < 0) return {};
  return AcrossLine((edges_[i].to - edges_[i].from).normalized(), nearest(i), p);
}

ProbeEquations ProbedPart::OfHole(const Vector3d& p) const {
  const Line* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Line& hole : holes_) {
    // Of holes in line with each other the one with the nearer mouth; along its axis a point may lie
    // anywhere.
    const double distance = (p - hole.from).squaredNorm();
    if (distance < least) least = distance, nearest = &hole;
  }
  if (nearest == nullptr) return {};
  return AcrossLine(nearest->to - nearest->from, nearest->from, p);
}

}  // namespace millpose
