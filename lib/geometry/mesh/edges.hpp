// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Side `k` of face `f` runs from its corner k to corner k+1; its number is 3 f + k.
using Side = int;
inline constexpr Side kNoSide = -1;
inline int FaceOf(Side side) { return side / 3; }
inline int CornerOf(Side side) { return side % 3; }
inline Side NextSide(Side side) { return side % 3 == 2 ? side - 2 : side + 1; }

/// A side with the vertices of its edge in ascending order.
struct EdgeSide {
  int low, high;
  Side side;
};

/// All sides sorted by edge, then by number: the sides of one edge stand together.
std::vector<EdgeSide> SortedSides(const Triangles& mesh);

/// The side over the same edge, by side; kNoSide at rims. An edge of more than two sides, or of two that do
/// not run against each other, is a bug (std::logic_error with the face).
std::vector<Side> PartnersOf(const Triangles& manifold);

/// Calls `visit(begin, end)` (indices into `sides`) for each edge.
template <typename Visit>
void ForEachEdge(const std::vector<EdgeSide>& sides, Visit visit) {
  for (size_t begin = 0; begin < sides.size();) {
    size_t end = begin + 1;
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high)
      ++end;
    visit(begin, end);
    begin = end;
  }
}

}  // namespace millpose
