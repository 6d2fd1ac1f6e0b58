// SPDX-License-Identifier: GPL-3.0-or-later
// From which station to which the external axes could go while a pass is milled (docs/external-axes.md).
#pragma once

#include "base/execution.hpp"
#include "job/external_positions.hpp"
#include "job/inputs.hpp"
#include "planning/external/station_sequence.hpp"
#include "planning/external/stations.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// The stations that axes with scope continuous may be at.
struct MovingStations {
  const Stations& stations;
  const std::vector<AxisPositions>& axes;
  const std::vector<ExternalPosition>& positions;  ///< those that are free
};

/// For each pass of a tool path in P: the most promising pairs of different stations, scored as stations are
/// with each point of the sample where the axes are then. Only axes with scope continuous differ, evenly and
/// within the bounds of their speeds, and no two bodies that stand still in passes come too near on the way.
/// None for rings that are left open. Throws Interrupted.
std::vector<std::vector<CourseScore>> ScoreMoving(const JobInputs& inputs, const MovingStations& moving,
                                                  const Toolpath& toolpath, const Execution& execution);

}  // namespace millpose
