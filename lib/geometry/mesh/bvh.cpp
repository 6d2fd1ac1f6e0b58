// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/bvh.hpp"

#include <numeric>

namespace millpose {

Bvh::Bvh(const std::vector<Eigen::AlignedBox3d>& boxes) {
  if (boxes.empty()) return;
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(boxes.size());
  nodes_.emplace_back();
  Build(0, 0, static_cast<int>(boxes.size()), boxes);
}

void Bvh::Build(int node, int first, int count, const std::vector<Eigen::AlignedBox3d>& boxes) {
  constexpr int kLeaf = 4;
  Eigen::AlignedBox3d box, centres;
  for (int i = first; i < first + count; ++i) {
    box.extend(boxes[order_[i]]);
    centres.extend(boxes[order_[i]].center());
  }
  nodes_[node].box = box;
  if (count <= kLeaf) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  Eigen::Index axis = 0;
  centres.diagonal().maxCoeff(&axis);
  const auto key = [&](int i) { return std::pair(boxes[i].center()[axis], i); };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) { return key(a) < key(b); });
  const int children = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  nodes_.emplace_back();
  nodes_[node].first = children;
  Build(children, first, count / 2, boxes);
  Build(children + 1, first + count / 2, count - count / 2, boxes);
}

}  // namespace millpose
