// SPDX-License-Identifier: GPL-3.0-or-later
// A job's compensation: from its settings to the commanded poses of its plan (docs/compensation.md).
#pragma once

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/external/stations.hpp"

namespace millpose {

/// What a job and its cell ask for and cannot have together, with the job's line where known.
std::vector<Problem> CheckCompensation(const JobSettings& job, const CellSettings& cell);

CompensationOptions MakeCompensationOptions(const JobSettings& job, const CellSettings& cell);

/// What a user is reported of it.
struct CompensationNotes {
  std::vector<std::string> findings, warnings;
  std::optional<double> remains;  ///< MedianRemains()
};

/// Sets `compensation` of a plan's points whose feeds are final. `planned_feeds`: by pass and point, those
/// that the forces were worked out for, mm/s. The straight motions between commanded poses, and those to and
/// from them, are checked as cuts are; a piece in which one is not free runs at its nominal poses and is a
/// finding. Throws InputError for measured forces that are not those of this plan's points; Interrupted.
CompensationNotes CompensateJob(const JobInputs& inputs, const Stations& stations,
                                const std::vector<std::vector<double>>& planned_feeds,
                                const Execution& execution, PlanResult& plan);

/// Of all points of a plan, by pass, mm/s.
std::vector<std::vector<double>> FeedsOf(const PlanResult& plan);

}  // namespace millpose
