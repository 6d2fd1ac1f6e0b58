// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/step_bound.hpp"

#include <algorithm>

namespace millpose {

double ToolWay(const MillingPoint& from, const MillingPoint& to) {
  const Eigen::Vector3d &a = from.tool_axis, &b = to.tool_axis;
  return std::max((to.position - from.position).norm(), kLever * (b - a).norm());
}

Joints StepBound(const StepBounds& bounds, const Arm& arm, const MillingPoint& from, const MillingPoint& to) {
  const double way = ToolWay(from, to), feed = std::max(from.feed_rate, to.feed_rate);
  Joints step = bounds.most.cwiseMin(std::min(bounds.per_mm * way, kPi));
  for (int j = 0; j < 6; ++j)
    if (arm.speed[j] > 0 && feed > 0)
      step[j] = std::min(step[j], bounds.speed_share * arm.speed[j] * way / feed);
  return step;
}

std::vector<Joints> StepBoundsAlong(const StepBounds& bounds, const Arm& arm,
                                    std::span<const MillingPoint> points) {
  std::vector<Joints> steps;
  for (size_t t = 0; t < points.size(); ++t)
    steps.push_back(StepBound(bounds, arm, points[t], points[(t + 1) % points.size()]));
  return steps;
}

}  // namespace millpose
