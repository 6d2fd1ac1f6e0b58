// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "report/html.hpp"
#include "stations/stations.hpp"

namespace millpose {

/// The nearest pair at every planned point that report.html shows. The same for any number of threads.
NearestPairs FindNearestPairs(const PlanResult& plan, const Stations& stations, int threads,
                              std::stop_token stop);

}  // namespace millpose
