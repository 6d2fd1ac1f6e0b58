// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/inputs.hpp"
#include "pipeline/make_programs.hpp"
#include "pipeline/output_folder.hpp"
#include "report/report.hpp"

namespace millpose {

/// Writes everything that a plan leaves in its folder: reports first, then, when every one of them was
/// confirmed by its own read-back, the programs. Returns what the reports tell beyond the plan.
ReportInputs WriteResults(const PlanResult& plan, const JobInputs& inputs,
                          const std::vector<CheckedProgram>& programs,
                          const std::optional<AuditFigures>& audit, const std::vector<std::string>& warnings,
                          const OutputFolder& folder);

/// Host, memory and the like for run.json.
RunFigures MeasureRun(int threads, const std::string& version);

}  // namespace millpose
