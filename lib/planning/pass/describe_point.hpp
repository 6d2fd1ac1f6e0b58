// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/refine.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// What a planned point says about itself: pose, objective and stiffness, from its node. `point.point` is at
/// the nominal lean before, at the node's after.
void DescribePoint(const PoseProblem& problem, const PathNode& node, PlannedPoint& point);

}  // namespace millpose
