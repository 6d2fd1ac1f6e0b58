// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/inputs.hpp"
#include "planning/result/timeline.hpp"

namespace millpose {

/// The run of a plan at the job's feeds, by the clock of the first controller that it names, else by the
/// arm's own limits.
Timeline PlanTimeline(const PlanResult& plan, const JobInputs& inputs);

}  // namespace millpose
