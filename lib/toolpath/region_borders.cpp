// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/region_borders.hpp"

#include "geometry/mesh/triangle.hpp"

namespace millpose {

RegionBorders::RegionBorders(const Mesh& mesh, const std::function<bool(int face)>& has_face) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int face = 0; face < mesh.face_count(); ++face) {
    if (!has_face(face)) continue;
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(face, k);
      if (other >= 0 && has_face(other)) continue;
      borders_.push_back({mesh.Corner(face, k), mesh.Corner(face, (k + 1) % 3)});
      boxes.emplace_back(borders_.back()[0]);
      boxes.back().extend(borders_.back()[1]);
    }
  }
  tree_ = Bvh(boxes);
}

double RegionBorders::Distance(const Eigen::Vector3d& p) const {
  const auto [nearest, squared] = tree_.Nearest(p, std::numeric_limits<double>::infinity(), [&](int i) {
    const auto& [a, b] = borders_[i];
    return (a + ClosestOnSegment(p, a, b) * (b - a) - p).squaredNorm();
  });
  return std::sqrt(squared);
}

}  // namespace millpose
