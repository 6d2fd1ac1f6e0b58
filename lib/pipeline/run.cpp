// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.hpp"

#include <thread>

#include "base/error.hpp"
#include "base/process.hpp"
#include "config/config.hpp"
#include "path/fixed_rotation.hpp"
#include "path/job_planner.hpp"
#include "path/strike_out.hpp"
#include "path/turns.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/audit.hpp"
#include "pipeline/job_engagement.hpp"
#include "pipeline/make_programs.hpp"
#include "pipeline/origin.hpp"
#include "pipeline/plan_passes.hpp"
#include "pipeline/sample_curves.hpp"
#include "pipeline/stages.hpp"
#include "pipeline/start_programs.hpp"
#include "pipeline/step_meshes.hpp"
#include "pipeline/workpiece.hpp"
#include "pipeline/write_results.hpp"

namespace millpose {
namespace {

constexpr size_t kMostCurves = 3000;  // points whose choice of pose report.html shows

std::filesystem::path FolderOf(const std::filesystem::path& job) {
  return job.has_parent_path() ? job.parent_path() : ".";
}

JobInputs ReadInputs(const PlanArguments& arguments, Stages& stages) {
  // The job may be the resolved one of a folder that a killed run left between two plans.
  MendOutputFolder(FolderOf(arguments.job));
  stages.Begin("read", 0);
  std::vector<Override> overrides = arguments.overrides;
  if (arguments.seed) overrides.push_back({"seed", std::to_string(*arguments.seed)});
  JobInputs inputs = LoadJobInputs(arguments.job, overrides, {}, arguments.root);
  inputs.max_points = arguments.max_points;
  if (!inputs.cell.programs_allowed && !inputs.job.programs.empty())
    throw InputError(
        {inputs.job.file},
        fmt::format("programs: cell {} is for reproduction only (reproduction_only: true), no programs "
                    "may be written for it; give `programs: []`",
                    inputs.cell.name));
  for (const std::string& controller : inputs.job.programs)
    MakePostSettings(inputs.job, inputs.cell, controller);  // refuses now what programs cannot be written for
  stages.End(fmt::format("job {}, cell {}", inputs.job.name, inputs.cell.name));
  return inputs;
}

// Beside the job; the resolved job of an output folder is planned there again.
std::filesystem::path DefaultFolder(const std::filesystem::path& job, const std::string& name) {
  const std::filesystem::path folder = FolderOf(job);
  return IsOutputFolder(folder) ? folder : folder / (name + ".out");
}

size_t PointsOf(const Share& share, const Toolpath& toolpath) {
  size_t count = 0;
  for (size_t i = share.index; i < toolpath.passes.size(); i += share.count)
    count += toolpath.passes[i].points.size();
  return count;
}

// Whether a pass may be run the other way round: where nothing that the poses depend on knows the feed's
// direction. A force does.
bool FreeDirections(const JobSettings& job, const Objective& objective) {
  const ToolpathSettings& toolpath = job.toolpath;
  const bool laid = toolpath.strategy != "curve" && toolpath.strategy != "cam";
  const bool upright = toolpath.lead == 0 && toolpath.tilt == 0;
  return laid && upright && !job.cutting && toolpath.direction == "zigzag" && !objective.DependsOnFeed();
}

PlanResult StartPlan(const JobInputs& inputs, const Cell& cell, const PoseProblem& problem) {
  PlanResult plan;
  plan.job = inputs.job.name;
  plan.cell = inputs.cell.name;
  plan.input_hash = inputs.hash;
  plan.seed = inputs.job.seed;
  plan.arm = cell.arm;
  plan.X_WB = cell.X_WB;
  plan.X_FT = cell.X_FT;
  plan.X_WP = cell.X_WP;
  plan.home = cell.home;
  plan.spindle_speed = inputs.job.spindle_speed;
  plan.objective_name = problem.objective->Name();
  plan.objective_unit = problem.objective->Unit();
  plan.stiffness_origin = inputs.cell.stiffness_at;
  return plan;
}

// What run.json says of a run that has ended, but for what it took from checkpoints.
RunFigures TellRun(const JobInputs& inputs, const OutputFolder& folder, const RunFigures::JobFile& job,
                   const Stages& stages, int threads) {
  RunFigures run = MeasureRun(threads, MILLPOSE_VERSION);
  run.program_id = ProgramId();
  run.job_folder = KeepOrigin(inputs.folder, folder.path());
  run.job = job;
  for (const StageTime& stage : stages.times()) {
    run.stages.push_back({stage.name, stage.seconds});
    run.wall_s += stage.seconds;
  }
  return run;
}

bool IsComplete(const PlanResult& plan, const ReportInputs& report) {
  const PlanFigures figures = Figures(plan);
  return figures.planned == figures.total && figures.gaps_planned == plan.gaps.size() &&
         report.findings.empty();
}

}  // namespace

PlanOutcome RunPlan(const PlanArguments& arguments, Progress& progress, std::stop_token stop) {
  const int threads =
      arguments.threads > 0 ? arguments.threads : static_cast<int>(std::thread::hardware_concurrency());
  Stages stages(progress);
  JobInputs inputs = ReadInputs(arguments, stages);
  const std::filesystem::path out = arguments.out.value_or(DefaultFolder(arguments.job, inputs.job.name));
  if (!arguments.out) arguments.root.CheckFolder(out);
  const OutputFolder folder(out, arguments.share ? FolderUse::kCheckpoints : FolderUse::kResults);
  const RunFigures::JobFile job_file = JobFileFor(arguments.job, inputs.job.name, folder.path());
  if (arguments.fresh && !arguments.share) folder.RemoveCheckpoints();

  if (!arguments.fresh) TakeKeptMeshes(folder, &inputs);
  stages.Begin("surface", 0, SurfaceStage(inputs));
  CutStepFiles(
      &inputs, [&](int percent) { progress.Percent(percent); }, stop);
  KeepMeshes(inputs, folder);
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  const Part part = ReadPart(inputs, cell);
  const ImportResult& surface = part.import;
  const Eigen::Vector3d size = surface.report.upper - surface.report.lower;
  stages.End(fmt::format("{}: {} triangles, {:.1f} x {:.1f} x {:.1f} mm", inputs.job.workpiece.mesh_file,
                         surface.report.triangles, size.x(), size.y(), size.z()));
  AddWorkpiece(inputs, surface.mesh.triangles(), &cell);
  stages.Begin("toolpath", 0);
  JobToolpath made = MakeJobToolpath(inputs, surface.mesh, stop);
  stages.End(fmt::format("{} points in {} passes", CountPoints(made.toolpath), made.toolpath.passes.size()));
  stages.Begin("gouges", 0);
  CheckJobGouges(inputs, surface.mesh, threads, made, stop);
  stages.End(fmt::format("{} points", made.gouges.points));
  const std::optional<CuttingForce> heaviest =
      SetJobEngagement(inputs, surface.mesh, threads, stop, made.toolpath);
  const Toolpath toolpath = PlacedToolpath(inputs, made.toolpath, cell.X_WP);
  std::vector<std::string> warnings = part.warnings;
  warnings.insert(warnings.end(), made.warnings.begin(), made.warnings.end());
  warnings.insert(warnings.end(), made.notes.begin(), made.notes.end());
  for (const std::string& hole : made.holes_left_out) made.findings.push_back("NOT MACHINED: " + hole);
  const PoseProblem problem = MakePoseProblem(inputs.job, inputs.cell, cell);
  const World world(cell);
  if (const auto found = Checker(world).At(cell.home, Phase::kFree))
    warnings.push_back(fmt::format("{}: home_deg: {}; no way from or to home can be planned",
                                   inputs.cell.file, Describe(*found)));

  PlanResult plan = StartPlan(inputs, cell, problem);
  const CheckpointUse checkpoints{folder, !arguments.fresh};
  const Share share = arguments.share.value_or(Share{});
  stages.Begin("passes", PointsOf(share, toolpath));
  PlannedPasses planned = PlanPasses(problem, world, toolpath, MakePathOptions(inputs.job), checkpoints,
                                     share, threads, progress, stop);
  plan.passes = std::move(planned.passes);
  stages.End(fmt::format("{} passes, {} of them from checkpoints", plan.passes.size(), planned.resumed));
  const std::string lock_warning = folder.warning().empty() ? "" : "warning    " + folder.warning() + '\n';
  if (arguments.share)
    return {0, fmt::format("share {} of {} is planned\n{}", share.index + 1, share.count, lock_warning)};

  FixTurns(plan.passes, {plan.home, problem.bounds.lower, problem.bounds.upper,
                         FreeDirections(inputs.job, *problem.objective)});
  stages.Begin("fixed rotations", 0);
  const FixedComparison fixed =
      CompareWithFixed(problem, world, plan.passes, MakeFixedOptions(inputs.job, threads, stop));
  stages.End(fmt::format("{} points compared", fixed.plan.size()));
  if (const std::string left = CountWhatIsLeft(inputs, surface.mesh, threads, stop, plan); !left.empty())
    warnings.push_back(left);
  const auto ends = GapEnds(plan.home, plan.passes);
  const auto start_ends = inputs.job.programs.empty() ? decltype(ends){} : StartEnds(ends);
  stages.Begin("gaps", ends.size() + start_ends.size());
  PlannedGaps gaps = PlanGaps(world, ends, MakeGapOptions(inputs.job), checkpoints, threads, progress, stop);
  plan.gaps = std::move(gaps.gaps);
  JobStarts starts;
  starts.ways.gaps =
      PlanGaps(world, start_ends, MakeGapOptions(inputs.job), checkpoints, threads, progress, stop).gaps;
  const FeedReduction reduction = inputs.job.feed_policy == "reduce" ? ReduceFeeds(plan) : FeedReduction{};
  stages.End(fmt::format("{} gaps, {} of them from checkpoints", plan.gaps.size(), gaps.resumed));

  stages.Begin("programs", 0);
  const JobPrograms programs =
      MakePrograms(plan, inputs, made.holes_left_out, world, arguments.trajectory, threads, stop);
  for (const CheckedProgram& program : programs.programs)
    if (program.Confirmed())
      starts.programs[program.controller] = MakeStartPrograms(plan, starts.ways, inputs, made.holes_left_out,
                                                              program.controller, world, threads, stop);
  stages.End(fmt::format("{} programs", programs.programs.size()));

  std::optional<AuditFigures> audit;
  if (arguments.audit) {
    stages.Begin("audit", 0);
    audit = Audit(plan, surface.mesh, cell, problem.bounds, inputs.job.swept_resolution, threads, stop);
    std::ranges::copy(Findings(*audit), std::back_inserter(made.findings));
    stages.End(fmt::format("{} contacts, {} clearances not kept, {} limit violations", audit->interferences,
                           audit->clearance_violations, audit->limit_violations));
  }

  stages.Begin("report", 0);
  const PathOptions path_options = MakePathOptions(inputs.job);
  const std::vector<PointCurves> curves =
      SampleCurves(plan, problem, path_options.genetic, kMostCurves, threads, stop);
  ResultSet results(folder);
  const ReportInputs report = WriteResults({inputs, cell, plan, programs, starts, audit, reduction, warnings,
                                            made.findings, CurveGrid(), curves, fixed, heaviest},
                                           results);
  stages.End(folder.path().string());
  RunFigures run = TellRun(inputs, folder, job_file, stages, threads);
  run.resumed_passes = planned.resumed;
  run.resumed_gaps = gaps.resumed;
  AddMeshes(inputs, &results);
  run.manifest = results.AddManifest(inputs.hash);
  results.Add(kRunFile, RunJson(run));
  results.Publish();
  return {IsComplete(plan, report) ? 0 : 1, SummaryText(plan, report, run) + lock_warning};
}

}  // namespace millpose
