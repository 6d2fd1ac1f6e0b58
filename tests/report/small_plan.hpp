// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "report/report.hpp"

namespace millpose {

inline std::string PointsCsv(const PlanResult& plan) {
  return BytesOf([&](const ByteSink& sink) { WritePointsCsv(plan, {}, nullptr, 2, sink); });
}

inline std::string PathVtp(const PlanResult& plan) {
  return BytesOf([&](const ByteSink& sink) { WritePathVtp(plan, 2, sink); });
}

// Three planned points and a skipped one with the plainest numbers.
inline PlanResult SmallPlan() {
  PlanResult plan;
  plan.job = "small";
  plan.objective_unit = "mm/N";
  PassResult pass;
  for (int i = 0; i < 4; ++i) {
    PlannedPoint point;
    point.point.position = Eigen::Vector3d(i, 0, 0);
    point.point.normal = point.point.tool_axis = Eigen::Vector3d::UnitZ();
    point.point.feed = Eigen::Vector3d::UnitX();
    point.freedoms = {0.5};
    point.objective = i + 1;
    point.own_optimum = 1;
    point.free_optimum = 1.5;
    point.unsmoothed = i + 0.75;
    point.indices.lambda_n = 1.0 / (i + 1);
    point.from_genetic = i == 0;
    point.clearance = 40 - i;
    pass.points.push_back(point);
  }
  pass.points[3].skip = Infeasibility::kLimit;
  pass.points[3].detail = "A5 beyond 117 deg";
  pass.pieces = {{0, 0, 0, 2, false}};
  plan.passes = {pass};
  LinkMove gap;
  gap.planned = true;
  gap.clearance = 12;
  LinkMove blocked;
  blocked.detail = "link3 against platform";
  plan.gaps = {gap, blocked};
  return plan;
}

}  // namespace millpose
