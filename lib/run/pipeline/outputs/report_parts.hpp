// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "report/html.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "store/checkpoints.hpp"

namespace millpose {

/// What report.html shows beside the plan and takes long to work out.
struct ReportParts {
  std::vector<PackedCurve> curves;
  AxisMap map;                     ///< of `curves`
  std::optional<Removal> removal;  ///< of the raw part, where there is one
};

/// The raw part while the plan mills it; empty where the job has none, or nothing is milled.
std::optional<Removal> RemovalOf(const JobInputs& inputs, const PlannedJob& job, const Timeline& timeline,
                                 const Execution& execution);

/// Works them out, or takes what they came to before. `full_map`: everything admissible is checked for it.
ReportParts MakeReportParts(const JobInputs& inputs, const PlannedJob& job, const Timeline& timeline,
                            bool full_map, const CheckpointStore& checkpoints, const Execution& execution);

}  // namespace millpose
