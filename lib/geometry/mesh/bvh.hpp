// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <vector>

namespace millpose {

/// A tree of bounding boxes over primitives numbered 0..n-1. Knows only their boxes; the caller measures the
/// primitives. Built by median splits, the same for the same input; queries are const and safe from many
/// threads.
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(const std::vector<Eigen::AlignedBox3d>& boxes);

  /// The primitive nearest to p and its squared distance, by `squared_distance(primitive)`; -1 when none is
  /// nearer than √`bound`.
  template <typename SquaredDistance>
  std::pair<int, double> Nearest(const Eigen::Vector3d& p, double bound,
                                 SquaredDistance squared_distance) const {
    int nearest = -1;
    if (!nodes_.empty()) Descend(0, p, nearest, bound, squared_distance);
    return {nearest, bound};
  }

  /// Calls `visit(primitive)` for each primitive whose box meets `box`.
  template <typename Visit>
  void ForEachIn(const Eigen::AlignedBox3d& box, Visit visit) const {
    ForEachWhere([&](const Eigen::AlignedBox3d& node) { return node.intersects(box); }, visit);
  }

  /// Calls `visit(primitive)` for the primitives of each leaf whose box, and whose parents' boxes, pass
  /// `meets(box)`.
  template <typename Meets, typename Visit>
  void ForEachWhere(Meets meets, Visit visit) const {
    int stack[kMaxDepth];
    int depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!meets(node.box)) continue;
      for (int i = 0; i < node.count; ++i) visit(order_[node.first + i]);
      if (node.count == 0) {
        stack[depth++] = node.first + 1;
        stack[depth++] = node.first;
      }
    }
  }

  /// Calls `visit(a, b)` for each two primitives of leaves whose boxes meet, once, until it returns false.
  template <typename Visit>
  void ForEachPair(Visit visit) const {
    ForEachLeafPair([&](std::span<const int> left, std::span<const int> right) {
      const bool same = left.data() == right.data();
      for (size_t i = 0; i < left.size(); ++i)
        for (size_t k = same ? i + 1 : 0; k < right.size(); ++k)
          if (!visit(left[i], right[k])) return false;
      return true;
    });
  }

  /// Calls `visit(left, right)` with the primitives of each two leaves whose boxes meet, once, and of each
  /// leaf with itself, until it returns false.
  template <typename Visit>
  void ForEachLeafPair(Visit visit) const {
    std::vector<std::pair<int, int>> stack;
    if (!nodes_.empty()) stack.emplace_back(0, 0);
    while (!stack.empty()) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      const Node &left = nodes_[a], &right = nodes_[b];
      if (a != b && !left.box.intersects(right.box)) continue;
      if (left.count > 0 && right.count > 0) {
        if (!visit(PrimitivesOf(left), PrimitivesOf(right))) return;
      } else if (a == b) {
        stack.insert(
            stack.end(),
            {{left.first, left.first}, {left.first + 1, left.first + 1}, {left.first, left.first + 1}});
      } else if (right.count > 0 || (left.count == 0 && left.box.diagonal().squaredNorm() >
                                                            right.box.diagonal().squaredNorm())) {
        stack.insert(stack.end(), {{left.first, b}, {left.first + 1, b}});
      } else {
        stack.insert(stack.end(), {{a, right.first}, {a, right.first + 1}});
      }
    }
  }

 private:
  static constexpr int kMaxDepth =
      128;  // a median split halves 2^31 primitives 31 times, two entries a level

  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0;  // leaf: into order_; else the left child, the right one follows it
    int count = 0;  // primitives of a leaf; 0 for an inner node
  };

  std::span<const int> PrimitivesOf(const Node& leaf) const {
    return std::span(order_).subspan(static_cast<size_t>(leaf.first), static_cast<size_t>(leaf.count));
  }

  void Build(int node, int first, int count, const std::vector<Eigen::AlignedBox3d>& boxes);

  template <typename SquaredDistance>
  void Descend(int index, const Eigen::Vector3d& p, int& nearest, double& bound,
               SquaredDistance& measure) const {
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (int i = 0; i < node.count; ++i) {
        const double distance = measure(order_[node.first + i]);
        if (distance < bound) {
          bound = distance;
          nearest = order_[node.first + i];
        }
      }
      return;
    }
    const double left = nodes_[node.first].box.squaredExteriorDistance(p);
    const double right = nodes_[node.first + 1].box.squaredExteriorDistance(p);
    const bool right_first = right < left;
    if ((right_first ? right : left) < bound)
      Descend(node.first + (right_first ? 1 : 0), p, nearest, bound, measure);
    if ((right_first ? left : right) < bound)
      Descend(node.first + (right_first ? 0 : 1), p, nearest, bound, measure);
  }

  std::vector<Node> nodes_;
  std::vector<int> order_;
};

}  // namespace millpose
