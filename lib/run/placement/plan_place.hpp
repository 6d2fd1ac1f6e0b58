// SPDX-License-Identifier: GPL-3.0-or-later
// A place or a station planned whole, and the settings that stand for it.
#pragma once

#include <map>

#include "run/placement/place_space.hpp"
#include "run/placement/run_place.hpp"

namespace millpose {

/// A place that was planned whole.
struct PlannedPlace {
  PoseSettings place;
  std::string folder;  ///< below the output folder
  size_t points = 0, planned = 0, gaps = 0, gaps_planned = 0;
  std::vector<std::optional<double>> worst, median;   ///< of the objective, one per operation
  std::vector<std::optional<double>> length, normal;  ///< worst |cF| and |n'cF|, mm, likewise
  std::optional<double> clearance;                    ///< mm
  std::map<std::string, double> cycle;                ///< s, by controller

  bool IsWhole() const { return planned == points && gaps_planned == gaps; }
};

/// The settings of a job that put the part, or the robot, in a place.
std::vector<Override> OverridesOf(const PoseSettings& place, bool robot);

/// The settings of one of several stations (from 1) of the job `name`.
std::vector<Override> StationOverrides(const std::string& name, size_t number, const PathSection& share,
                                       const PoseSettings& place, bool robot);

/// The arguments of `millpose plan` into a folder.
PlanArguments AsPlan(const PlaceArguments& arguments, const std::filesystem::path& out);

/// Plans the job with `changes` into `out`/plans/`name`. Throws InputError, Interrupted.
PlannedPlace PlanWhole(const PlaceArguments& arguments, const std::filesystem::path& out,
                       const std::string& name, const std::vector<Override>& changes,
                       const Execution& execution);

}  // namespace millpose
