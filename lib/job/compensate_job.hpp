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

/// The deviations that a job takes out of its programs; empty where it does not.
std::optional<ArmDeviations> CommandedDeviations(const JobSettings& job, const CellSettings& cell);

/// Where the job takes the arm's deviations out, the same stations with the arm as it is: what moves in them
/// is what will move. Else `stations` themselves.
Stations StationsAsItIs(const JobInputs& inputs, const Stations& stations);

/// Where the job takes the arm's deviations out, sets `compensation` of all points by them alone, and leaves
/// out (LeaveOut) pieces that the arm as it is does not reach. Returns how many. Throws InputError where a
/// tip would be moved by more than compensation.max_deviation_mm.
size_t CommandForTheArm(const JobInputs& inputs, PlanResult& plan);

/// Leaves out pieces that CommandForTheArm commanded and that are not free there, their ways to the retracts
/// included. Returns how many. Throws Interrupted.
size_t LeaveOutBlocked(const JobInputs& inputs, const Stations& as_it_is, const Execution& execution,
                       PlanResult& plan);

/// What a user is reported of it.
struct CompensationNotes {
  std::vector<std::string> findings, warnings;
  std::optional<double> remains;  ///< MedianRemains()
};

/// Sets `compensation` of a plan's points whose feeds are final; `stations`: of the arm as it is.
/// `planned_feeds`: by pass and point, those that the forces were worked out for, mm/s. The straight motions
/// between commanded poses, and those to and from them, are checked as cuts are; a piece in which one is not
/// free runs at its nominal poses and is a finding. Throws InputError for measured forces that are not those
/// of this plan's points; Interrupted.
CompensationNotes CompensateJob(const JobInputs& inputs, const Stations& stations,
                                const std::vector<std::vector<double>>& planned_feeds,
                                const Execution& execution, PlanResult& plan);

/// Of all points of a plan, by pass, mm/s.
std::vector<std::vector<double>> FeedsOf(const PlanResult& plan);

}  // namespace millpose
