// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/edges.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace millpose {

std::vector<EdgeSide> SortedSides(const Triangles& mesh) {
  // Counted by the lower vertex: of each vertex there are few, which are sorted by themselves.
  std::vector<size_t> first(mesh.vertices.size() + 1, 0);
  const auto for_each = [&](const auto& take) {
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]);
        take(EdgeSide{low, high, static_cast<Side>(3 * f + k)});
      }
  };
  for_each([&](const EdgeSide& side) { ++first[static_cast<size_t>(side.low) + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<EdgeSide> sides(3 * mesh.faces.size());
  std::vector<size_t> next = first;
  for_each([&](const EdgeSide& side) { sides[next[static_cast<size_t>(side.low)]++] = side; });
  for (size_t vertex = 0; vertex + 1 < first.size(); ++vertex)
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(first[vertex]),
              sides.begin() + static_cast<std::ptrdiff_t>(first[vertex + 1]),
              [](const EdgeSide& a, const EdgeSide& b) {
                return std::tie(a.high, a.side) < std::tie(b.high, b.side);
              });
  return sides;
}

}  // namespace millpose
