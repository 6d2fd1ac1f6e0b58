// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/surface_rays.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

int SideOf(const Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return normal[axis] < 0 ? axis + 3 : axis;
}

/// The coordinates across an axis.
Vector2d Across(const Vector3d& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

/// Twice the area to the left of a → b at p, with the same bits (but for the sign) from both sides of the
/// edge, so that a place on it belongs to one face.
double LeftOf(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const bool swapped = std::tuple(b.x(), b.y()) < std::tuple(a.x(), a.y());
  const Vector2d &from = swapped ? b : a, &to = swapped ? a : b;
  const double area = (to.x() - from.x()) * (p.y() - from.y()) - (to.y() - from.y()) * (p.x() - from.x());
  return swapped ? -area : area;
}

/// A face as seen along an axis, its corners counter-clockwise.
class SeenFace {
 public:
  SeenFace(const Mesh& mesh, int face, int side) {
    for (int k = 0; k < 3; ++k) corners_[k] = Across(mesh.Corner(face, k), side % 3);
    if (side >= 3) std::swap(corners_[1], corners_[2]);
  }

  bool Holds(const Vector2d& p) const {
    for (int k = 0; k < 3; ++k) {
      const Vector2d &a = corners_[k], &b = corners_[(k + 1) % 3];
      const double left = LeftOf(a, b, p);
      const bool owned = b.y() < a.y() || (b.y() == a.y() && b.x() < a.x());
      if (left < 0 || (left == 0 && !owned)) return false;
    }
    return true;
  }

  /// First and last step of the lattice along a coordinate.
  std::pair<int, int> Steps(int coordinate, double spacing) const {
    const auto [low, high] =
        std::minmax({corners_[0][coordinate], corners_[1][coordinate], corners_[2][coordinate]});
    return {static_cast<int>(std::floor(low / spacing)), static_cast<int>(std::ceil(high / spacing))};
  }

 private:
  Vector2d corners_[3];
};

}  // namespace

std::vector<SurfaceRay> RaysOver(const Region& region, double spacing) {
  const Mesh& mesh = region.mesh();
  std::vector<SurfaceRay> rays;
  for (int face = 0; face < mesh.face_count(); ++face) {
    if (!region.HasFace(face)) continue;
    const Vector3d& normal = mesh.FaceNormal(face);
    const int side = SideOf(normal), axis = side % 3;
    const SeenFace seen(mesh, face, side);
    const auto [first_i, last_i] = seen.Steps(0, spacing);
    const auto [first_j, last_j] = seen.Steps(1, spacing);
    for (int i = first_i; i <= last_i; ++i)
      for (int j = first_j; j <= last_j; ++j) {
        const Vector2d p((i + 0.5) * spacing, (j + 0.5) * spacing);
        if (!seen.Holds(p)) continue;
        Vector3d origin = Vector3d::Zero();
        origin[(axis + 1) % 3] = p.x();
        origin[(axis + 2) % 3] = p.y();
        origin[axis] = normal.dot(mesh.Corner(face, 0) - origin) / normal[axis];
        if (region.Margin(face, origin) >= 0) rays.push_back({origin, normal, side, i, j});
      }
  }
  std::ranges::sort(rays, {}, [](const SurfaceRay& ray) {
    return std::tuple(ray.side, ray.i, ray.j, ray.origin[ray.side % 3]);
  });
  return rays;
}

double CountRays(const Region& region, double spacing) {
  const Mesh& mesh = region.mesh();
  double area = 0;
  for (int face = 0; face < mesh.face_count(); ++face)
    if (region.HasFace(face)) {
      const Vector3d& a = mesh.Corner(face, 0);
      area += 0.5 * (mesh.Corner(face, 1) - a).cross(mesh.Corner(face, 2) - a).cwiseAbs().maxCoeff();
    }
  return area / (spacing * spacing);
}

std::vector<std::array<int, 2>> NextRays(const std::vector<SurfaceRay>& rays, double spacing) {
  const auto key = [](const SurfaceRay& ray) { return std::tuple(ray.side, ray.i, ray.j); };
  const auto next = [&](const SurfaceRay& ray, int di, int dj) {
    const auto found = std::ranges::equal_range(rays, std::tuple(ray.side, ray.i + di, ray.j + dj), {}, key);
    const auto nearest = std::ranges::min_element(
        found, {}, [&](const SurfaceRay& other) { return (other.origin - ray.origin).squaredNorm(); });
    if (nearest == found.end() || (nearest->origin - ray.origin).norm() > 2 * spacing) return -1;
    return static_cast<int>(nearest - rays.begin());
  };
  std::vector<std::array<int, 2>> neighbours;
  for (const SurfaceRay& ray : rays) neighbours.push_back({next(ray, 1, 0), next(ray, 0, 1)});
  return neighbours;
}

}  // namespace millpose
