// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "report/html.hpp"

namespace millpose {

/// The nearest pair at each of some planned points of a pass.
using PairsOfPoints = std::vector<std::optional<Interference>>;
PairsOfPoints FindPairsOfPoints(const PassResult& pass, const std::vector<size_t>& points,
                                const Stations& stations, const Execution& execution);

/// The nearest pair at every planned point that report.html shows, by `find(pass, points)`, which is asked
/// once of each pass with points near something, from many threads. The same for any number of threads.
NearestPairs FindNearestPairs(
    const PlanResult& plan, const Execution& execution,
    const std::function<PairsOfPoints(const PassResult& pass, const std::vector<size_t>& points)>& find);

}  // namespace millpose
