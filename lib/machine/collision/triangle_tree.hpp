// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace millpose {

/// The triangles of a mesh under a tree of boxes, for what FCL does not answer: whether a point is inside,
/// and how far apart a body is for certain. FCL's own tree is of no use for either
/// (docs/decisions/0040-lower-bounds.md).
class TriangleTree {
 public:
  struct Node {
    Eigen::Vector3d lower, upper;  ///< mm, mesh frame
    int first = 0, count = 0;      ///< triangles of a leaf; an inner node has none
    int right = 0;                 ///< second child of an inner node; the first follows its parent
  };
  using Corners = std::array<Eigen::Vector3d, 3>;

  TriangleTree() = default;
  TriangleTree(const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces);

  bool empty() const { return nodes_.empty(); }
  /// The root first.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// In the order of the leaves.
  const std::vector<Corners>& triangles() const { return triangles_; }

 private:
  void Build(std::vector<Corners>& triangles, int first, int count);

  std::vector<Node> nodes_;
  std::vector<Corners> triangles_;
};

}  // namespace millpose
