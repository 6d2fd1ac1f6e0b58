// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/run.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "job/compensate_job.hpp"
#include "job/config/config.hpp"
#include "job/step_meshes.hpp"
#include "report/samples/judge_optima.hpp"
#include "report/samples/sample_curves.hpp"
#include "run/pipeline/audit/audit.hpp"
#include "run/pipeline/outputs/predict_face.hpp"
#include "run/pipeline/outputs/report_parts.hpp"
#include "run/pipeline/outputs/run_record.hpp"
#include "run/pipeline/outputs/up_to_date.hpp"
#include "run/pipeline/outputs/write_results.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"
#include "run/pipeline/stages/stages.hpp"
#include "store/folder_checkpoints.hpp"

namespace millpose {
namespace {

JobInputs ReadInputs(const PlanArguments& arguments, Stages& stages) {
  stages.Begin("read", 0);
  JobInputs inputs =
      LoadJobInputs(arguments.job, OverridesOf(arguments), {}, arguments.root, arguments.operation);
  inputs.max_points = arguments.max_points;
  inputs.cut_before = arguments.cut_before;
  inputs.trajectory = arguments.trajectory;
  CheckPrograms(inputs);
  if (arguments.face) RequireFace(inputs);
  stages.End(fmt::format("job {}, cell {}", inputs.job.name, inputs.cell.name));
  return inputs;
}

bool IsComplete(const PlanResult& plan, const ReportInputs& report) {
  const PlanFigures figures = Figures(plan);
  return figures.planned == figures.total && figures.gaps_planned == plan.gaps.size() &&
         report.findings.empty();
}

// The judge's figures; what is wrong by them joins the findings.
AuditFigures JudgePlan(const JobInputs& inputs, const Execution& execution, PlannedJob& job,
                       std::vector<std::string>& findings) {
  execution.progress.Begin("audit", 0);
  AuditRules rules{job.prepared.problem.bounds, MakeCutterShape(inputs.cell.tool),
                   inputs.job.swept_resolution, CommandedDeviations(inputs.job, inputs.cell)};
  if (const PartBending* bending = BendingOf(inputs.job)) rules.bending = *bending;
  AuditFigures audit = Audit(job.plan, job.prepared.surface.mesh, job.prepared.cell, rules, execution);
  JudgeOptima(job.prepared.stations, inputs.job.path.genetic, inputs.job.exhaustive_step, execution, job.plan,
              audit);
  std::ranges::copy(Findings(audit), std::back_inserter(findings));
  execution.progress.End(fmt::format("{} contacts, {} clearances not kept, {} limit violations",
                                     audit.interferences, audit.clearance_violations,
                                     audit.limit_violations));
  return audit;
}

// The face that the plan will leave, beside the best fixed rotation's.
FaceReport PredictedFace(const JobInputs& inputs, const PlannedJob& job, const Execution& execution) {
  execution.progress.Begin("face", 0);
  FaceOptions options;
  if (job.fixed.job.Exists())
    options.rotation = job.fixed.job.rotations.front();
  else
    options.fixed_in_the_way = job.fixed.job_in_the_way;
  FaceReport face = PredictFace(inputs, job.plan, job.prepared.surface.mesh,
                                job.prepared.stations.AtOwnAxis(), options, execution);
  execution.progress.End(fmt::format("{} places", face.plan.expected.figures.rays));
  return face;
}

// An operation's folder is a part of the set of its job's, which nobody else puts in its place.
void RefuseOperation(const std::filesystem::path& out) {
  const std::filesystem::path operations = std::filesystem::weakly_canonical(out).parent_path();
  if (operations.filename() == kOperationsFolder && IsOutputFolder(operations.parent_path()))
    throw InputError(
        {out.string()},
        fmt::format("is of one operation of the job whose folder is {}; allowed: that job "
                    "({}), or another folder with -o DIR",
                    operations.parent_path().string(), (operations.parent_path() / "job.yaml").string()));
}

// Whose plan stands in a folder: of the inputs, and of what operations before have left of the raw part.
std::string KeyOf(const JobInputs& inputs, const PlanArguments& arguments) {
  return arguments.before.empty() ? inputs.hash : Hash(inputs.hash + '\0' + arguments.before);
}

// What `inputs` are planned into: checkpoints into `folder`, results into what `results` makes.
struct Destination {
  const OutputFolder& folder;
  std::function<ResultSet&()> results;
};

// How that ended; `made`: it is in the results, and does not stand in the folder already.
struct Planned {
  PlanOutcome outcome;
  bool made = false;
};

Planned WritePlanned(const PlanArguments& arguments, const JobInputs& inputs, const RunFigures& begun,
                     const FolderCheckpoints& checkpoints, PlannedJob& job, const Destination& to,
                     Stages& stages, const Execution& execution) {
  std::vector<std::string> findings = job.prepared.made.findings;
  std::optional<AuditFigures> audit;
  if (arguments.audit) audit = JudgePlan(inputs, execution, job, findings);
  std::optional<FaceReport> face;
  if (arguments.face) face = PredictedFace(inputs, job, execution);

  stages.Begin("report", 0);
  const Timeline timeline = PlanTimeline(job.plan, inputs);
  const ReportParts parts =
      MakeReportParts(inputs, job, timeline, arguments.full_axis_map, checkpoints, execution);
  ResultSet& results = to.results();
  const ReportInputs report = WriteResults({inputs,
                                            job.prepared.cell,
                                            job.plan,
                                            job.programs,
                                            job.starts,
                                            audit,
                                            job.reduction,
                                            job.prepared.warnings,
                                            findings,
                                            CurveGrid(),
                                            parts,
                                            timeline,
                                            job.fixed,
                                            job.faces,
                                            job.prepared.heaviest,
                                            job.compensation_remains,
                                            job.stock,
                                            std::move(face),
                                            arguments.language,
                                            execution},
                                           results);
  stages.End(to.folder.path().string());
  RunFigures run = EndRun(begun, stages, execution.Threads());
  run.resumed_passes = job.resumed_passes;
  run.resumed_gaps = job.resumed_gaps;
  AddMeshes(inputs, &results);
  run.manifest = results.AddManifest(KeyOf(inputs, arguments));
  run.exit_status = IsComplete(job.plan, report) ? 0 : 1;
  run.told = BriefText(job.plan, report, to.folder.path().string());
  run.details = SummaryText(job.plan, report, run);
  results.AddRun(RunJson(run));
  return {{run.exit_status, arguments.verbose ? run.details : run.told}, true};
}

Planned PlanInto(const Destination& to, const PlanArguments& arguments, JobInputs inputs, Stages& stages,
                 const Execution& execution) {
  const RunFigures begun = BeginRun(arguments, inputs.job.name, inputs.folder, to.folder);
  if (arguments.fresh && !arguments.share) to.folder.RemoveCheckpoints();
  const FolderCheckpoints checkpoints(to.folder, !arguments.fresh);
  if (!arguments.fresh) {
    TakeCachedMeshes(to.folder, &inputs);
    const auto standing = FindExistingPlan(to.folder.path(), KeyOf(inputs, arguments), begun);
    if (standing && !arguments.share)
      return {{standing->exit_status, standing->Told(arguments.verbose) + kUnchanged}, false};
  }
  stages.Begin(SurfaceStage(inputs), 0);  // which PrepareJob goes on with
  CutStepFiles(
      &inputs, [&](int percent) { stages.Percent(percent); }, execution.stop);
  KeepMeshes(inputs, to.folder);
  if (arguments.share) {
    PlanShare(inputs, *arguments.share, checkpoints, execution);
    return {
        {0, fmt::format("share {} of {} is planned\n", arguments.share->index + 1, arguments.share->count)},
        false};
  }
  PlannedJob job = PlanJob(inputs, checkpoints, execution, LaidPoints::kGo);
  return WritePlanned(arguments, inputs, begun, checkpoints, job, to, stages, execution);
}

}  // namespace

std::string WarningLines(const OutputFolder& folder) {
  std::string lines;
  for (const std::string& warning : folder.warnings()) lines += "warning    " + warning + '\n';
  return lines;
}

PlanOutcome PlanOperation(const PlanArguments& arguments, const OutputFolder& folder, ResultSet* whole,
                          Progress& progress, std::stop_token stop) {
  Stages stages(progress);
  JobInputs inputs = ReadInputs(arguments, stages);
  std::optional<ResultSet> results;
  const auto of_whole = [&]() -> ResultSet& { return results.emplace(*whole, folder); };
  const Planned planned = PlanInto({folder, of_whole}, arguments, std::move(inputs), stages,
                                   {arguments.threads, stages, std::move(stop)});
  if (!planned.made && whole) of_whole().AddStanding();
  return planned.outcome;
}

PlanOutcome RunPlan(const PlanArguments& arguments, Progress& progress, std::stop_token stop) {
  Stages stages(progress);
  JobInputs inputs = ReadInputs(arguments, stages);
  const std::filesystem::path out = arguments.out.value_or(DefaultFolder(arguments.job, inputs.job.name));
  if (!arguments.out) arguments.root.CheckFolder(out);
  RefuseOperation(out);
  const OutputFolder folder(out, arguments.share ? FolderUse::kCheckpoints : FolderUse::kResults);
  ResultSet results(folder, kPlanNames);
  Planned planned = PlanInto({folder, [&]() -> ResultSet& { return results; }}, arguments, std::move(inputs),
                             stages, {arguments.threads, stages, std::move(stop)});
  if (planned.made) {
    results.Publish();
    folder.KeepOperations({});  // which the job had before
  }
  planned.outcome.text += WarningLines(folder);
  return planned.outcome;
}

}  // namespace millpose
