// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategies/ring_frame.hpp"
#include "toolpath/strategies/spread.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

/// What a spiral about an axis follows.
struct SpiralPlan {
  const Region& region;
  const ToolpathOptions& options;
  const RingFrame& frame;
  bool walls;              ///< positions are heights, else radii
  const PassScale& scale;  ///< two passes or more
  std::function<std::vector<Curve>(double position)> slice;

  double Position(const Eigen::Vector3d& p) const { return walls ? frame.Height(p) : frame.axis().Radius(p); }
};

/// A ring, turns with even pitch (of passes), a ring: without the rings the first and last turn would leave a
/// crescent. Throws InputError when it needs too many triangles; Interrupted.
CurveGroup MakeSpiral(const SpiralPlan& plan, const std::stop_token& stop);

}  // namespace millpose
