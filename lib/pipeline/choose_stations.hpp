// SPDX-License-Identifier: GPL-3.0-or-later
// Where the external axes stand while each pass is milled (docs/external-axes.md).
#pragma once

#include "base/execution.hpp"
#include "path/stations.hpp"
#include "pipeline/inputs.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

struct StationChoices {
  std::vector<ExternalPosition> external;  ///< of each pass
  /// Of each pass: further stations, the most promising first; none where there is nothing to choose.
  std::vector<std::vector<ExternalPosition>> elsewhere;
  std::vector<std::string> warnings;
};

/// Where the external axes stand for each pass of a tool path in P. Where the job leaves positions to the
/// planner every pass is scored by a sample of its points at every station, interference counted, and the
/// stations are chosen along the order of the passes: the fewest points lost, with the worst point first
/// where the objective says so, then the least sum with a price for every change. Throws InputError where no
/// station is free; Interrupted.
StationChoices ChooseStations(const JobInputs& inputs, const Stations& stations, const Execution& execution,
                              const Toolpath& toolpath);

}  // namespace millpose
