// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Checks the straight motions between a plan's commanded poses, and those to and from the retracts, for
/// interference as cuts are checked. A piece in which one is not free runs at its nominal poses; what was in
/// the way is returned, one sentence a piece. Throws Interrupted.
std::vector<std::string> KeepCommandedFree(const Stations& stations, double swept_resolution,
                                           const Execution& execution, PlanResult& plan);

}  // namespace millpose
