// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/triangle_tree.hpp"

#include <algorithm>
#include <limits>

namespace millpose {
namespace {

constexpr int kLeafSize = 4;

}  // namespace

TriangleTree::TriangleTree(const std::vector<Eigen::Vector3d>& vertices,
                           const std::vector<std::array<int, 3>>& faces) {
  triangles_.reserve(faces.size());
  for (const auto& f : faces) triangles_.push_back({vertices[f[0]], vertices[f[1]], vertices[f[2]]});
  nodes_.reserve(faces.size());
  if (!faces.empty()) Build(triangles_, 0, static_cast<int>(faces.size()));
}

void TriangleTree::Build(std::vector<Corners>& triangles, int first, int count) {
  Node node;
  node.lower.setConstant(std::numeric_limits<double>::infinity());
  node.upper = -node.lower;
  for (int i = first; i < first + count; ++i) {
    for (const Eigen::Vector3d& corner : triangles[i]) {
      node.lower = node.lower.cwiseMin(corner);
      node.upper = node.upper.cwiseMax(corner);
    }
  }
  const size_t index = nodes_.size();
  if (count <= kLeafSize) {
    node.first = first;
    node.count = count;
    nodes_.push_back(node);
    return;
  }
  nodes_.push_back(node);
  int axis = 0;
  (node.upper - node.lower).maxCoeff(&axis);
  const auto centre = [axis](const Corners& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
  std::stable_sort(triangles.begin() + first, triangles.begin() + first + count,
                   [&](const Corners& a, const Corners& b) { return centre(a) < centre(b); });
  const int half = count / 2;
  Build(triangles, first, half);
  nodes_[index].right = static_cast<int>(nodes_.size());
  Build(triangles, first + half, count - half);
}

}  // namespace millpose
