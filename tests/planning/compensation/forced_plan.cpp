// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/planning/compensation/forced_plan.hpp"

namespace millpose {

using Eigen::Vector3d;

PlanResult Forced(double newtons) {
  PlanResult plan = SamplePlan({.points = 20});
  plan.arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;  // Chen 2021, eq. 14
  for (PassResult& pass : plan.passes)
    for (size_t i = 0; i < pass.points.size(); ++i) {
      MillingPoint& point = pass.points[i].point;
      const Vector3d way = pass.points[std::min(i + 1, pass.points.size() - 1)].point.position -
                           pass.points[i == 0 ? 0 : i - 1].point.position;
      point.feed = (way - way.dot(point.normal) * point.normal).normalized();
      point.feed_rate = 20;
      point.engagement.side = CutSide::kDown;
      point.engagement.depth = 1;
      point.engagement.force = newtons * (0.8 * point.normal + 0.6 * point.feed);
    }
  return plan;
}

CompensationOptions Sure() {
  CompensationOptions options;
  options.deflection = TakeOut::kNormal;
  options.force = {0, 0};
  options.stiffness = {Joints::Zero(), 0};
  return options;
}

}  // namespace millpose
