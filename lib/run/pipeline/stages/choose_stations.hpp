// SPDX-License-Identifier: GPL-3.0-or-later
// Where the external axes stand while each pass is milled (docs/external-axes.md).
#pragma once

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "planning/external/external_course.hpp"
#include "planning/external/stations.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

struct StationChoices {
  std::vector<ExternalCourse> external;  ///< of each pass
  /// Of each pass: further stations, the most promising first; none where there is nothing to choose. Of a
  /// pass along which axes move the first is the best of those that stand.
  std::vector<std::vector<ExternalCourse>> elsewhere;
  std::vector<std::string> warnings;
};

/// Where the external axes stand for each pass of a tool path in P. Where the job leaves positions to the
/// planner every pass is scored by a sample of its points at every station, interference counted, and the
/// stations are chosen along the order of the passes: the fewest points lost, with the worst point first
/// where the objective says so, then the least sum with a price for every change. Axes with scope continuous
/// may go from one station to another along a pass (moving_stations.hpp). Throws InputError where no station
/// is free; Interrupted.
StationChoices ChooseStations(const JobInputs& inputs, const Stations& stations, const Execution& execution,
                              const Toolpath& toolpath);

}  // namespace millpose
