// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/unwind.hpp"

#include "base/units.hpp"
#include "machine/robot/angles.hpp"

namespace millpose {
namespace {

/// Least and largest angles along a piece whose joints are continuous.
std::pair<Joints, Joints> ExtentOf(std::span<const PathNode> path, bool closed) {
  Joints least = path[0].q, most = path[0].q;
  for (const PathNode& node : path) {
    least = least.cwiseMin(node.q);
    most = most.cwiseMax(node.q);
  }
  if (closed) {  // back to the first point, by whatever turns the way round has made
    const Joints end = NearestEquivalent(path.back().q, path[0].q);
    least = least.cwiseMin(end);
    most = most.cwiseMax(end);
  }
  return {least, most};
}

}  // namespace

bool Unwind(std::span<PathNode> path, bool closed, const AdmissibleBounds& bounds) {
  for (size_t i = 1; i < path.size(); ++i) path[i].q = NearestEquivalent(path[i - 1].q, path[i].q);
  const auto [least, most] = ExtentOf(path, closed);
  for (int j = 0; j < 6; ++j) {
    bool fits = false;
    for (const int turns : {0, -1, 1, -2, 2}) {
      const double shift = turns * 2 * kPi;
      if (least[j] + shift < bounds.lower[j] - kRevolutionRounding ||
          most[j] + shift > bounds.upper[j] + kRevolutionRounding) {
        continue;
      }
      for (PathNode& node : path) node.q[j] += shift;
      fits = true;
      break;
    }
    if (!fits) return false;
  }
  return true;
}

}  // namespace millpose
