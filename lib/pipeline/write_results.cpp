// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/write_results.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include "config/config.hpp"
#include "pipeline/assemble.hpp"
#include "toolpath/pass_ends.hpp"

namespace millpose {
namespace {

constexpr size_t kFindingsKept = 20;  // per program: the rest says the same

// How many motions of a program end on points of each pass.
std::vector<int> MotionsPerPass(const CheckedProgram& program, size_t passes) {
  std::vector<int> counts(passes, 0);
  for (const int pass : program.pass_of_motion)
    if (pass >= 0) ++counts.at(static_cast<size_t>(pass));
  return counts;
}

std::string ExplainFeed(const ContinuityFigures& continuity) {
  const FeedFinding& first = continuity.feed_not_held.front();
  return fmt::format(
      "the feed cannot be held at {} points; first at point {} (pass {}): the {} of A{} allows {:.1f} of "
      "{:.1f} "
      "mm/min; `process.feed: reduce` runs such points as fast as the joints can",
      continuity.feed_not_held.size(), first.point, first.pass,
      first.by_acceleration ? "acceleration" : "speed", first.joint + 1, 60 * first.feed_possible,
      60 * first.feed);
}

// Splits whose parts could not overlap.
std::string ExplainUncut(const PassResult& pass) {
  std::vector<std::string> steps;
  for (const int t : pass.uncut) {
    const Eigen::Vector3d& p = pass.points[static_cast<size_t>(t)].point.position;
    steps.push_back(fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z()));
  }
  return fmt::format(
      "pass {} is split and not cut from the point at {} to the next: no pose of either part reaches over",
      pass.pass, fmt::join(steps, ", "));
}

std::vector<std::string> Explain(const PlanResult& plan, const std::vector<CheckedProgram>& programs) {
  std::vector<std::string> sentences;
  const std::string obstacle = WhyNotProgrammable(plan);
  if (!obstacle.empty()) sentences.push_back("no program was written: " + obstacle);
  for (const PassResult& pass : plan.passes)
    if (!pass.uncut.empty()) sentences.push_back(ExplainUncut(pass));
  for (const CheckedProgram& program : programs) {
    for (size_t i = 0; i < std::min(program.findings.size(), kFindingsKept); ++i) {
      const Finding& finding = program.findings[i];
      sentences.push_back(
          fmt::format("{} {}:{}: {}", program.controller, finding.file, finding.line, finding.message));
    }
    if (program.findings.size() > kFindingsKept)
      sentences.push_back(
          fmt::format("{}: {} findings more", program.controller, program.findings.size() - kFindingsKept));
  }
  return sentences;
}

// The first pass of the last layer: every layer has the same passes, one layer after the other.
int FinishedFrom(const JobSettings& job, size_t passes) {
  const DepthSettings& depth = job.toolpath.depth;
  const size_t layers = LayerOffsets({depth.total, depth.per_layer, depth.allowance, depth.finishing}).size();
  return static_cast<int>(passes - passes / layers);
}

}  // namespace

ReportInputs WriteResults(const Results& results, ResultSet& set) {
  const PlanResult& plan = results.plan;
  const std::vector<CheckedProgram>& programs = results.programs.programs;
  ReportInputs report;
  report.base_window = results.programs.base_window;
  report.audit = results.audit;
  report.warnings = results.warnings;
  report.findings = results.findings;
  for (std::string& sentence : Explain(plan, programs)) report.findings.push_back(std::move(sentence));
  report.continuity = AnalyseContinuity(plan);
  report.feed_reduction = results.reduction;
  for (const CheckedProgram& program : programs) {
    for (const std::string& warning : program.warnings)
      report.warnings.push_back(program.controller + ": " + warning);
  }
  if (results.inputs.job.feed_policy == "keep" && !report.continuity->feed_not_held.empty())
    report.findings.push_back(ExplainFeed(*report.continuity));
  if (const auto force = MakeCuttingForce(results.inputs.job, results.inputs.cell))
    report.deflection = PredictDeflections(plan, *force, MakeCompliances(results.inputs.cell),
                                           FinishedFrom(results.inputs.job, plan.passes.size()));
  std::map<std::string, std::string> files;
  for (const CheckedProgram& program : programs)
    for (const auto& [name, bytes] : program.files) {
      const std::string path = program.controller + "/" + name;
      files[path] = bytes;
      report.programs.push_back({"programs/" + path, program.controller,
                                 MotionsPerPass(program, plan.passes.size()), program.saved, program.near,
                                 program.findings.empty()});
    }
  const std::string job = WriteJob(results.inputs.job), cell = WriteCell(results.inputs.cell);
  set.Add("job.yaml", job);
  set.Add("cell.yaml", cell);
  set.Add(kPlanFile, Serialise(plan));
  set.Add("points.csv", PointsCsv(plan));
  set.Add("path.vtp", PathVtp(plan));
  if (report.deflection) set.Add("deflection.csv", DeflectionCsv(*report.deflection));
  set.Add("summary.json", SummaryJson(plan, report));
  set.Add("report.html",
          ReportHtml({plan, results.cell, results.grid, results.curves, job + "\n" + cell,
                      report.deflection ? &*report.deflection : nullptr, report.findings, report.warnings}));
  // One program that its read-back does not confirm casts doubt on the plan: none is written then.
  if (results.programs.Confirmed())
    for (const auto& [name, bytes] : files) set.Add(fmt::format("{}/{}", kProgramsFolder, name), bytes);
  return report;
}

RunFigures MeasureRun(int threads, const std::string& version) {
  RunFigures run;
  run.threads = threads;
  run.version = version;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  run.peak_memory_MB = static_cast<double>(usage.ru_maxrss) / 1024;
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  run.host = host;
  return run;
}

}  // namespace millpose
