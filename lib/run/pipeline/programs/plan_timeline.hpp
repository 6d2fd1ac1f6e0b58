// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/inputs.hpp"
#include "planning/result/timeline.hpp"
#include "program/program_time.hpp"

namespace millpose {

/// The job's feeds and dwells, for the motions of its plan without a controller.
MotionOptions RunOptions(const JobSettings& job);
/// The clock of the first controller that the job names, else the arm's own limits.
TimeOptions RunClock(const JobInputs& inputs);

/// The run of a plan with both.
Timeline PlanTimeline(const PlanResult& plan, const JobInputs& inputs);

}  // namespace millpose
