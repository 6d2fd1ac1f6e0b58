// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "planning/pose/search.hpp"
#include "report/html.hpp"

namespace millpose {

/// The rotations at which SampleCurves looks: every 3° from −180°.
RotationGrid CurveGrid();

/// The same problem without bounds: an objective is worked out for admissible candidates alone, and the page
/// shows also what the bounds forbid.
PoseProblem WithoutBounds(PoseProblem problem);

/// For report.html: the objective over the rotation on all branches, and the genetic algorithm run once more
/// with each point's own stream of `seed` (so its generations are those of the plan). At most `most` points:
/// all of them, or every k-th with the worst by objective. The same for any number of threads.
std::vector<PointCurves> SampleCurves(const PlanResult& plan, const Stations& stations,
                                      const GeneticOptions& options, size_t most, const Execution& execution);

}  // namespace millpose
