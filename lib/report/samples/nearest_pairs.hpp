// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "report/html.hpp"

namespace millpose {

/// The nearest pair at every planned point that report.html shows. The same for any number of threads.
NearestPairs FindNearestPairs(const PlanResult& plan, const Stations& stations, const Execution& execution);

}  // namespace millpose
