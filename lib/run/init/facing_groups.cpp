// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/facing_groups.hpp"

#include <algorithm>
#include <limits>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Vector3d MiddleOf(const Mesh& mesh, int face) {
  return (mesh.Corner(face, 0) + mesh.Corner(face, 1) + mesh.Corner(face, 2)) / 3;
}

/// Faces that hang together over edges without a crease.
std::vector<std::vector<int>> SmoothFaces(const Mesh& mesh, double crease_deg) {
  const double least = SinCos(DegToRad(crease_deg)).cos;
  std::vector<char> seen(static_cast<size_t>(mesh.face_count()));
  std::vector<std::vector<int>> groups;
  for (int first = 0; first < mesh.face_count(); ++first) {
    if (seen[static_cast<size_t>(first)]) continue;
    std::vector<int> group{first};
    seen[static_cast<size_t>(first)] = 1;
    for (size_t i = 0; i < group.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const int next = mesh.Neighbour(group[i], k);
        if (next < 0 || seen[static_cast<size_t>(next)]) continue;
        if (mesh.FaceNormal(next).dot(mesh.FaceNormal(group[i])) < least) continue;
        seen[static_cast<size_t>(next)] = 1;
        group.push_back(next);
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Directions along and halfway between the axes: what people set parts up by.
std::vector<Vector3d> RoundDirections() {
  std::vector<Vector3d> directions;
  for (const int x : {0, 1, -1})
    for (const int y : {0, 1, -1})
      for (const int z : {0, 1, -1})
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vector3d(x, y, z).normalized());
  return directions;
}

/// What of `faces` faces `direction`.
FacingGroup Facing(const Mesh& mesh, const std::vector<int>& faces, const Vector3d& direction, bool flat) {
  const double least = SinCos(DegToRad(flat ? kFlatWithinDeg : kCurvedWithinDeg)).cos;
  FacingGroup group;
  group.direction = direction;
  group.flat = flat;
  group.lower.setConstant(std::numeric_limits<double>::max());
  group.upper.setConstant(std::numeric_limits<double>::lowest());
  std::vector<int> facing;
  for (const int face : faces) {
    if (mesh.FaceNormal(face).dot(direction) < least) continue;
    facing.push_back(face);
    group.area += AreaOf(mesh, face);
    for (int k = 0; k < 3; ++k) {
      group.lower = group.lower.cwiseMin(mesh.Corner(face, k));
      group.upper = group.upper.cwiseMax(mesh.Corner(face, k));
    }
  }
  // A hole in the middle must not move the seed off the group.
  const Vector3d middle = (group.lower + group.upper) / 2;
  double nearest = std::numeric_limits<double>::max();
  for (const int face : facing) {
    const Vector3d place = mesh.ClosestOnFace(middle, face).position;
    const double distance = (place - middle).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    group.seed = (9 * place + MiddleOf(mesh, face)) / 10;  // off the face's border, which others share
  }
  return group;
}

/// The way in which most of some smooth faces look.
FacingGroup BestFacing(const Mesh& mesh, const std::vector<int>& faces) {
  Vector3d sum = Vector3d::Zero();
  double area = 0;
  for (const int face : faces) {
    sum += AreaOf(mesh, face) * mesh.FaceNormal(face);
    area += AreaOf(mesh, face);
  }
  FacingGroup best;
  if (sum.norm() > 0.5 * area) {
    const Vector3d mean = sum.normalized();
    FacingGroup flat = Facing(mesh, faces, mean, true);
    if (flat.area > 0.999 * area) return flat;
    best = Facing(mesh, faces, mean, false);
  }
  for (const Vector3d& direction : RoundDirections()) {
    const FacingGroup other = Facing(mesh, faces, direction, false);
    if (other.area > 1.1 * best.area) best = other;
  }
  return best;
}

/// Of the faces between creases the largest, by what of them faces one way.
std::vector<FacingGroup> GroupsBetween(const Mesh& mesh, double crease_deg, size_t most) {
  const std::vector<std::vector<int>> smooth = SmoothFaces(mesh, crease_deg);
  std::vector<std::pair<double, size_t>> areas;
  for (size_t i = 0; i < smooth.size(); ++i) {
    double area = 0;
    for (const int face : smooth[i]) area += AreaOf(mesh, face);
    areas.emplace_back(area, i);
  }
  std::ranges::stable_sort(areas, std::greater{}, &std::pair<double, size_t>::first);
  std::vector<FacingGroup> groups;
  for (size_t i = 0; i < std::min(areas.size(), 2 * most); ++i) {
    FacingGroup group = BestFacing(mesh, smooth[areas[i].second]);
    group.crease_deg = crease_deg;
    if (group.area > 0) groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace

std::vector<FacingGroup> FindFacingGroups(const Mesh& mesh, size_t most) {
  std::vector<FacingGroup> groups;
  for (const bool flat : {true, false})
    for (FacingGroup& group : GroupsBetween(mesh, flat ? kFlatCreaseDeg : kGroupCreaseDeg, most))
      if (group.flat == flat) groups.push_back(std::move(group));
  // Of faces of one size the part's upper one.
  const auto weight = [](const FacingGroup& group) {
    return (group.flat ? 3 : 1) * group.area * (1 + 1e-6 * group.direction.z());
  };
  std::ranges::stable_sort(groups, std::greater{}, weight);
  if (groups.size() > most) groups.resize(most);
  return groups;
}

}  // namespace millpose
