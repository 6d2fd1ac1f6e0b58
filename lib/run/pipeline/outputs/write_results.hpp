// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/assemble.hpp"
#include "job/inputs.hpp"
#include "report/html.hpp"
#include "report/report.hpp"
#include "run/pipeline/outputs/report_parts.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "run/pipeline/programs/start_programs.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// What the stages made and WriteResults writes.
struct Results {
  const JobInputs& inputs;
  const Cell& cell;  ///< with the workpiece
  const PlanResult& plan;
  const JobPrograms& programs;
  const JobStarts& starts;
  const std::optional<AuditFigures>& audit;
  const FeedReduction& reduction;
  const std::vector<std::string>& warnings;  ///< repairs of the mesh, doubtful units
  const std::vector<std::string>& findings;  ///< of earlier stages
  RotationGrid grid;                         ///< of the curves
  const ReportParts& parts;                  ///< for report.html, as is the next
  const Timeline& timeline;
  const FixedComparison& fixed;  ///< outlives the returned
  const std::vector<FaceChoice>& faces;
  const std::optional<CuttingForce>& heaviest;  ///< where the job says what is cut
  std::optional<double> compensation_remains;
  std::optional<StockFigures> stock = std::nullopt;  ///< where the job has a raw part
  std::optional<FaceReport> face;                    ///< where it was asked for
  Language language = Language::kEnglish;            ///< in which report.html opens
  const Execution& execution;
};

/// Adds everything that a plan leaves in its folder, but for what differs from run to run: reports, and the
/// programs of every controller whose read-back confirmed them. Returns what the reports tell beyond the
/// plan.
ReportInputs WriteResults(const Results& results, ResultSet& set);

/// How well the cell says that the tool is known; empty where it does not.
std::optional<ToolUncertainty> UncertaintyOf(const ToolSettings& tool);

/// Host, memory and the like for run.json.
RunFigures MeasureRun(int threads, const std::string& version);

}  // namespace millpose
