// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of the sample jobs, cut down and kept as text: programs are tested on them without planning, and a
// planner that finds other poses changes no golden file. They are input data and need not be what the jobs
// are planned to today (they are of a version before smoothing); the slow tests plan the jobs themselves.
#pragma once

#include "job/inputs.hpp"
#include "machine/collision/cell.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Joint angles (17 digits), pieces, gaps and feeds of a plan.
std::string Freeze(const PlanResult& plan);
/// What Freeze() wrote, completed with arm, tool and places of the job's cell.
PlanResult Thaw(const std::string& text, const JobInputs& inputs, const Cell& cell);

/// One sample: its job with everything that it names, cell with workpiece, cut-down plan.
struct Sample {
  JobInputs inputs;
  Cell cell;
  PlanResult plan;
};
/// support_pad, cabin_panel, cabin_ring.
Sample LoadSample(const std::string& name);
std::vector<std::string> SampleNames();

}  // namespace millpose
