// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "planning/pose/scorer.hpp"
#include "report/html.hpp"

namespace millpose {

/// What bars the poses of the points of `curves`, on the rotations of CurveGrid, all branches: limits,
/// singularities and reach as the curves have them, interference is what the plan learned of it. With `full`
/// what it never looked at is checked too. The same for any number of threads.
AxisMap MakeAxisMap(const PlanResult& plan, const Stations& stations, const std::vector<PointCurves>& curves,
                    bool full, const Execution& execution);

/// The joint that is farthest beyond its limits, 0..5, and by how much, rad: full revolutions are taken off
/// first.
struct BeyondLimit {
  int joint = 0;
  double by = 0;
};
BeyondLimit FarthestBeyond(const AdmissibleBounds& bounds, const Joints& q);

}  // namespace millpose
