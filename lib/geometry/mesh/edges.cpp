// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/edges.hpp"

namespace millpose {

std::vector<EdgeSide> SortedSides(const Triangles& mesh) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * mesh.faces.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]);
      sides.push_back({low, high, static_cast<Side>(3 * f + k)});
    }
  std::ranges::sort(sides, [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.side) < std::tie(b.low, b.high, b.side);
  });
  return sides;
}

}  // namespace millpose
