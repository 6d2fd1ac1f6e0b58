// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/result/timeline.hpp"
#include "program/program_time.hpp"

namespace millpose {

/// What motion `i` of a plan's program does; never kMissing.
RunPart PartOf(const PlanResult& plan, const MotionProgram& program, size_t i);

/// The run of a plan by the time law of its motion program (TimeMotions): every planned point and what lies
/// between pieces. Its end is MeasureTime of that program. A gap that could not be planned takes no time, and
/// the arm leaps over it. Calls of the plant are left out.
Timeline MakeTimeline(const PlanResult& plan, MotionOptions options, const TimeOptions& times);

}  // namespace millpose
