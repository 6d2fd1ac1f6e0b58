// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "toolpath/strategies/loop.hpp"

namespace millpose {

/// A line of equal distance from a pad's borders. `level` counts from 0 at the borders inwards; higher
/// distances lie on the left.
struct PadRing {
  Loop loop;
  int level = 0;
};

/// Joins rings to as few curves as can be: each ring is gone round once, then the way steps on to a neighbour
/// that is near; to neighbours that lie elsewhere it steps from the ring on its way round, and back when they
/// and theirs are done. `step` (mm): distance of neighbouring levels. What is not milled lies on the right
/// with `climb`, else on the left. `free` tells whether the tool may go straight between two points.
std::vector<Curve> JoinRings(std::vector<PadRing> rings, double step, bool climb,
                             const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& free);

}  // namespace millpose
