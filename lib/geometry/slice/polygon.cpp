// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/polygon.hpp"

namespace millpose {
namespace {

// Newell's normal: right for concave and not quite plane polygons.
Eigen::Vector3d NormalOf(const Triangles& mesh, const std::vector<int>& corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& origin = mesh.vertices[corners[0]];
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    normal += (mesh.vertices[corners[i]] - origin).cross(mesh.vertices[corners[i + 1]] - origin);
  return normal;
}

// Whether corner i turns left and no other corner lies in the triangle that it cuts off.
bool IsEar(const Triangles& mesh, const std::vector<int>& corners, size_t i, const Eigen::Vector3d& normal) {
  const size_t count = corners.size(), before = (i + count - 1) % count, after = (i + 1) % count;
  const Eigen::Vector3d &a = mesh.vertices[corners[before]], &b = mesh.vertices[corners[i]],
                        &c = mesh.vertices[corners[after]];
  const auto left = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
    return normal.dot((q - p).cross(r - p)) > 0;
  };
  if (!left(a, b, c)) return false;
  for (size_t k = 0; k < count; ++k) {
    if (k == before || k == i || k == after) continue;
    const Eigen::Vector3d& p = mesh.vertices[corners[k]];
    if (left(a, b, p) && left(b, c, p) && left(c, a, p)) return false;
  }
  return true;
}

}  // namespace

void AppendPolygon(Triangles& mesh, const std::vector<int>& corners) {
  std::vector<int> rest = corners;
  if (rest.size() < 3) return;
  const Eigen::Vector3d normal = NormalOf(mesh, rest);
  while (rest.size() > 3) {
    size_t ear = 0;
    while (ear < rest.size() && !IsEar(mesh, rest, ear, normal)) ++ear;
    if (ear == rest.size()) ear = 0;  // crossing itself or without area: any cut is as good
    const size_t count = rest.size();
    mesh.faces.push_back({rest[(ear + count - 1) % count], rest[ear], rest[(ear + 1) % count]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  mesh.faces.push_back({rest[0], rest[1], rest[2]});
}

}  // namespace millpose
