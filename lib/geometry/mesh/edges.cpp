// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
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

std::vector<Side> PartnersOf(const Triangles& manifold) {
  std::vector<Side> partners(3 * manifold.faces.size(), kNoSide);
  const std::vector<EdgeSide> sides = SortedSides(manifold);
  const auto start = [&](Side side) { return manifold.faces[FaceOf(side)][CornerOf(side)]; };
  ForEachEdge(sides, [&](size_t begin, size_t end) {
    if (end - begin == 1) return;
    const Side a = sides[begin].side, b = sides[begin + 1].side;
    if (end - begin > 2 || start(a) == start(b))
      throw std::logic_error(fmt::format("face {} ({}) does not fit into the manifold", FaceOf(b),
                                         fmt::join(manifold.faces[FaceOf(b)], ", ")));
    partners[a] = b;
    partners[b] = a;
  });
  return partners;
}

}  // namespace millpose
