// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "planning/result/plan_result.hpp"
#include "toolpath/lean_law.hpp"

namespace millpose {

/// Whether the pose search has chosen how the tool leans.
inline bool HasLeans(const PlanResult& plan) {
  return std::ranges::any_of(plan.passes, [](const PassResult& pass) {
    return std::ranges::any_of(pass.points,
                               [](const PlannedPoint& planned) { return planned.freedoms.size() > 1; });
  });
}

/// Of a planned point, rad.
inline Leans LeansOf(const PlannedPoint& planned) {
  return LeansOf(planned.point.tool_axis, planned.point.normal, planned.point.feed);
}

}  // namespace millpose
