// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_job.hpp"

#include "base/counted.hpp"
#include "base/error.hpp"
#include "base/free_memory.hpp"
#include "job/assemble.hpp"
#include "job/compensate_job.hpp"
#include "job/job_engagement.hpp"
#include "job/lean_freedoms.hpp"
#include "job/locate.hpp"
#include "job/plausible.hpp"
#include "job/raw_stock.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/pass/pass_checks.hpp"
#include "planning/pass/revolutions.hpp"
#include "planning/result/skipped.hpp"
#include "run/pipeline/programs/program_stage.hpp"
#include "run/pipeline/stages/compare_fixed.hpp"
#include "run/pipeline/stages/finer_passes.hpp"
#include "run/pipeline/stages/other_stations.hpp"
#include "run/pipeline/stages/other_ways.hpp"
#include "run/pipeline/stages/plan_faces.hpp"
#include "run/pipeline/stages/plan_link_moves.hpp"
#include "run/pipeline/stages/plan_passes.hpp"
#include "run/pipeline/stages/repair_ends.hpp"

namespace millpose {
namespace {

PlanResult StartPlan(const JobInputs& inputs, const PreparedJob& prepared) {
  const Cell& cell = prepared.cell;
  const PoseProblem& problem = prepared.problem;
  PlanResult plan;
  plan.job = inputs.job.name;
  plan.cell = inputs.cell.name;
  plan.input_hash = inputs.hash;
  plan.seed = inputs.job.seed;
  plan.arm = cell.arm;
  plan.external_axes = cell.external_axes;
  plan.X_WB = cell.X_WB;
  plan.X_FT = cell.X_FT;
  plan.X_WP = cell.X_WP;
  plan.home = cell.home;
  plan.spindle_speed = prepared.made.spindle_speed.value_or(inputs.job.spindle_speed);
  plan.objective_name = problem.objective->Name();
  plan.objective_unit = problem.objective->Unit();
  plan.stiffness_origin = inputs.cell.stiffness_at;
  return plan;
}

PlannedPasses PlanPassesOf(const JobInputs& inputs, PreparedJob& prepared, const Share& share,
                           const CheckpointStore& checkpoints, const Execution& execution) {
  const auto own = [&](size_t pass) { return share.Has(pass); };
  PlannedPasses planned = PlanBestWays(inputs, prepared, checkpoints, own, execution);
  PlanOtherStations(inputs, prepared, checkpoints, own, execution, planned.passes);
  PlanFiner(inputs, prepared, checkpoints, own, execution, planned.passes);
  return planned;
}

// Of passes that are milled whole or not at all: leaves out what is left of those with skipped points.
size_t LeaveIncomplete(const Toolpath& toolpath, std::vector<PassResult>& passes) {
  size_t left_out = 0;
  for (PassResult& pass : passes) {
    if (!toolpath.passes[static_cast<size_t>(pass.pass)].whole || CountSkipped(pass) == 0) continue;
    for (; !pass.pieces.empty(); ++left_out)
      LeaveOut(
          pass, static_cast<int>(pass.pieces.size()) - 1, Infeasibility::kIncomplete,
          "other points of its hole or contour are skipped, and these are milled completely or not at all");
  }
  return left_out;
}

// Of how many pieces not all full revolutions were compared.
size_t FixRevolutions(const JobInputs& inputs, const PoseProblem& problem, PlanResult& plan) {
  return ChooseRevolutions(plan.passes, {plan.home, problem.bounds.lower, problem.bounds.upper,
                                         FreeDirections(inputs.job) && !inputs.job.toolpath.Leans() &&
                                             !DependsOnFeed(inputs.job, *problem.objective)});
}

// Pieces that would meet what still stands of the raw part, with their own ways to and from them.
int LeaveInRawStock(const JobInputs& inputs, const Execution& execution, PlannedJob& job, AirCourse& air) {
  const Triangles raw = RawStock(inputs);
  if (raw.faces.empty()) return 0;
  size_t pieces = 0;
  for (const PassResult& pass : job.plan.passes) pieces += pass.pieces.size();
  execution.progress.Begin("stock", pieces);
  StandingStock stock(raw, inputs.job.workpiece.stock_resolution);
  for (const CutsOfTool& cuts : inputs.cut_before)
    stock.Remove(cuts.cutter, cuts.motions, execution.Threads(), execution.stop);
  const double air_margin = inputs.cell.air_feed.value_or(AirFeedSettings()).margin;
  LeftInStock left = LeaveInStock(job.prepared.cell, MakeCutterShape(inputs.cell.tool), air_margin, stock,
                                  execution, job.plan);
  const StockFigures& figures = left.figures;
  air = std::move(left.air);
  const int left_out = figures.left_out + (job.stock ? job.stock->left_out : 0);
  job.stock = figures;
  job.stock->left_out = left_out;
  execution.progress.End(
      fmt::format("{:.0f} of {:.0f} cm3 milled off", figures.removed / 1e3, figures.blank / 1e3));
  return figures.left_out;
}

// Feeds of the points, at last. Returns those that forces were computed for, pass by pass.
std::vector<std::vector<double>> SettleFeeds(const JobInputs& inputs, const AirCourse& air, PlannedJob& job) {
  std::vector<std::vector<char>> raised;
  if (const auto& fast = inputs.cell.air_feed; fast && job.stock)
    raised = RaiseFeedsInAir(air, fast->feed, fast->longer_than, job.plan);
  std::vector<std::vector<double>> feeds = FeedsOf(job.plan);
  if (inputs.job.feed_policy == FeedPolicy::kReduce) job.reduction = ReduceFeeds(job.plan);
  if (job.stock) job.stock->air = TimeInAir(air, raised, job.plan);
  return feeds;
}

void WarnOfTurned(PlannedJob& job) {
  constexpr size_t kNamed = 20;
  std::vector<size_t> turned;
  for (size_t i = 0; i < job.prepared.turned.size(); ++i)
    if (job.prepared.turned[i] != 0) turned.push_back(i);
  if (turned.empty()) return;
  const char* more = turned.size() > kNamed ? ", ..." : "";
  turned.resize(std::min(turned.size(), kNamed));
  job.prepared.warnings.push_back(fmt::format(
      "toolpath: passes {}{} run from their other end, where {} (direction: zigzag leaves it open)",
      fmt::join(turned, ", "), more,
      job.prepared.problem.objective->JudgesFace() ? "the face errs less" : "the force bends the arm less"));
}

// Passes come in their directions and turns, then the ways between them.
void PlanWays(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
              PlannedJob& job) {
  PlanResult& plan = job.plan;
  RepairEnds({job.prepared.stations, job.prepared.toolpath, job.prepared.external},
             MakePathOptions(inputs.job), MakeLinkMoveOptions(inputs.job).leave, checkpoints, execution,
             plan.passes);
  job.faces = PlanFaces(inputs, job.prepared, checkpoints, execution, plan.passes);
  WarnOfTurned(job);
  const size_t narrowed = FixRevolutions(inputs, job.prepared.problem, plan);
  if (narrowed > 0)
    job.prepared.warnings.push_back(fmt::format(
        "the limits of the axes admit many full revolutions of {} pieces: only those nearest home "
        "are compared (arm.limits_deg, limits.joints_deg)",
        narrowed));
  const LinkMoveOptions options = MakeLinkMoveOptions(inputs.job);
  MissingCuts missing(inputs, job.prepared.surface.mesh, execution);
  const auto leave_over_missing = [&] {
    return LeaveIncomplete(job.prepared.toolpath, plan.passes) + missing.LeaveOut(plan);
  };
  const Stations as_it_is = StationsAsItIs(inputs, job.prepared.stations);
  const auto plan_gaps = [&] {
    while (CommandForTheArm(inputs, plan) > 0) leave_over_missing();
    SwapCommanded(plan.passes);  // ways lead to where the arm is commanded
    PlannedLinkMoves gaps = PlanAllLinkMoves(as_it_is, plan.passes, options, checkpoints, execution);
    SwapCommanded(plan.passes);
    plan.gaps = std::move(gaps.gaps);
    return gaps.resumed;
  };
  leave_over_missing();
  execution.progress.Begin("gaps", LinkMoveEnds(HomeOf(plan), plan.passes).size());
  job.resumed_gaps = plan_gaps();
  const auto settle =
      [&] {  // over pieces that no way leads to, or that are not free where they are commanded
        while (leave_over_missing() > 0 || LeaveOutBlocked(inputs, as_it_is, execution, plan) > 0)
          plan_gaps();
      };
  settle();
  execution.progress.End(
      fmt::format("{} gaps, {} of them from checkpoints", plan.gaps.size(), job.resumed_gaps));
  AirCourse air;
  while (LeaveInRawStock(inputs, execution, job, air) > 0) {
    leave_over_missing();
    plan_gaps();
    settle();
  }
  ForgetCommanded(plan.passes);
  execution.progress.Begin("fixed rotations", 0);
  job.fixed = CompareFixed(inputs, job.prepared, plan.passes, checkpoints, execution);
  execution.progress.End(fmt::format("{} points compared", job.fixed.plan.points));
  const std::string left = missing.Count(plan);
  if (!left.empty()) job.prepared.warnings.push_back(left);
  const std::string entries = EntriesOnMaterial(inputs, job.prepared.surface.mesh, plan);
  if (!entries.empty()) job.prepared.warnings.push_back(entries);
  const auto feeds = SettleFeeds(inputs, air, job);
  const CompensationNotes notes = CompensateJob(inputs, as_it_is, feeds, execution, plan);
  std::ranges::copy(notes.warnings, std::back_inserter(job.prepared.warnings));
  std::ranges::copy(notes.findings, std::back_inserter(job.prepared.made.findings));
  job.compensation_remains = notes.remains;
  if (inputs.job.programs.empty()) return;
  const bool own_arm = inputs.job.compensation.deviations;
  if (own_arm) SwapCommanded(plan.passes);
  const auto start_ends = StartEnds(LinkMoveEnds(HomeOf(plan), plan.passes));
  if (own_arm) SwapCommanded(plan.passes);
  execution.progress.Begin("starts", start_ends.size());
  job.starts.ways.gaps = PlanLinkMoves(as_it_is, start_ends, options, checkpoints, execution).gaps;
  execution.progress.End(Counted(start_ends.size(), "way", "ways"));
}

/// Passes of more than twice `most` points keep every n-th of them, so that about `most` stay, their ends,
/// and the ends of leads; returns whether one has.
bool Thin(size_t most, Toolpath& toolpath) {
  bool thinned = false;
  for (Pass& pass : toolpath.passes) {
    const std::vector<MillingPoint> all = std::move(pass.points);
    const size_t every = all.size() > 2 * most ? (all.size() + most - 1) / most : 1;
    pass.points.clear();
    for (size_t i = 0; i < all.size(); ++i)
      if (i % every == 0 || i + 1 == all.size() || all[i].kind != all[i - 1].kind ||
          all[i].kind != all[i + 1].kind)
        pass.points.push_back(all[i]);
    thinned |= pass.points.size() < all.size();
  }
  return thinned;
}

/// Of a trial: about how many points a pass keeps, and how many all of them have as laid.
struct Trial {
  size_t most = 1, laid = 0;
};

PreparedJob Prepare(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
                    Trial* trial = nullptr) {
  Progress& progress = execution.progress;
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  TellDoubts(DoubtsOf({inputs.cell, cell, &inputs.job}), inputs);  // here only what is refused
  progress.Begin(SurfaceStage(inputs), 0);
  Part part = ReadPart(inputs, cell);
  const Mesh& mesh = part.import.mesh;
  const Eigen::Vector3d size = part.import.report.upper - part.import.report.lower;
  progress.End(fmt::format("{}: {} triangles, {:.1f} x {:.1f} x {:.1f} mm", inputs.job.workpiece.mesh_file,
                           part.import.report.triangles, size.x(), size.y(), size.z()));
  LayingInputs laying = MakeLayingInputs(inputs, mesh);
  auto [made, heaviest] = LayPath(laying, checkpoints, execution);
  if (trial) trial->laid = CountPoints(made.toolpath);
  if (trial && Thin(trial->most, made.toolpath)) {
    progress.Begin("fewer points", 0);
    progress.End(fmt::format("{} of {} points, farther apart", CountPoints(made.toolpath), trial->laid));
  }
  std::ranges::move(TellDoubts(DoubtsOf({inputs.cell, cell, &inputs.job, size, heaviest}), inputs),
                    std::back_inserter(made.findings));
  AddWorkpiece(inputs, mesh.triangles(), &cell);
  for (const std::string& hole : made.holes_left_out) made.findings.push_back("NOT MACHINED: " + hole);
  std::vector<std::string> warnings = std::move(part.warnings);
  std::ranges::copy(made.warnings, std::back_inserter(warnings));
  made.notes.insert(made.notes.begin(), inputs.cell.notes.begin(), inputs.cell.notes.end());
  std::ranges::copy(made.notes, std::back_inserter(warnings));
  const World world(cell);
  PoseProblem problem = MakePoseProblem(inputs.job, inputs.cell, cell);
  BoundLeans(inputs, mesh, cell.X_WP, &problem);
  const Stations stations(world, problem);
  if (const auto found = Checker(stations.At(stations.home()).world).At(cell.home, Phase::kFree))
    warnings.push_back(HomeWarning(inputs.cell.file, *found));
  StationChoices choices = ChooseStations(inputs, stations.AtOwnAxis(), execution, made.toolpath);
  std::ranges::move(choices.warnings, std::back_inserter(warnings));
  Toolpath toolpath = AtStations(inputs, made.toolpath, stations, choices.external);
  return {std::move(cell),
          world,
          std::move(part.import),
          std::move(laying),
          std::move(made),
          std::move(toolpath),
          {},
          std::move(problem),
          stations,
          std::move(choices.external),
          std::move(choices.elsewhere),
          heaviest,
          std::move(warnings)};
}

}  // namespace

namespace {

void CheckControllers(const JobInputs& inputs) {
  if (!inputs.cell.programs_allowed && !inputs.job.programs.empty())
    throw InputError(
        {inputs.job.file},
        fmt::format("programs: cell {} is for reproduction only (reproduction_only: true), no programs "
                    "may be written for it; give `programs: []`",
                    inputs.cell.name));
  for (const std::string& controller : inputs.job.programs)
    MakePostSettings(inputs.job, inputs.cell, controller);  // refuses now what programs cannot be written for
}

}  // namespace

std::string HomeWarning(const std::string& cell_file, const Interference& found) {
  return fmt::format("{}: home_deg: {}; no way from or to home can be planned", cell_file, Describe(found));
}

void CheckPrograms(const JobInputs& inputs) {
  WithPlaces(inputs, [&] { CheckControllers(inputs); });
}

PreparedJob PrepareJob(const JobInputs& inputs, const CheckpointStore& checkpoints,
                       const Execution& execution) {
  return WithPlaces(inputs, [&] { return Prepare(inputs, checkpoints, execution); });
}

PlannedJob PlanJob(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
                   LaidPoints laid) {
  CheckPrograms(inputs);
  PlannedJob job{PrepareJob(inputs, checkpoints, execution), {}, {}, {}, {}, {}, {}, {}, {}};
  job.plan = StartPlan(inputs, job.prepared);
  PlannedPasses planned = PlanPassesOf(inputs, job.prepared, Share{}, checkpoints, execution);
  job.plan.passes = std::move(planned.passes);
  job.resumed_passes = planned.resumed;
  PlanWays(inputs, checkpoints, execution, job);
  if (laid == LaidPoints::kGo) {
    job.prepared.made.toolpath = {};
    job.prepared.toolpath = {};
    ReleaseFreeMemory();
  }
  MakeJobPrograms(inputs, checkpoints, execution, job);
  return job;
}

namespace {

/// What of a plan would be a finding; empty: nothing.
std::string ProblemOf(const JobInputs& inputs, const PreparedJob& prepared, const PlanResult& plan) {
  if (!prepared.made.findings.empty()) return prepared.made.findings.front();
  for (const PassResult& pass : plan.passes) {
    for (const PlannedPoint& point : pass.points)
      if (point.skip != Infeasibility::kNone)
        return fmt::format("pass {}: {}", pass.pass,
                           point.detail.empty() ? "a point is skipped" : point.detail);
    if (!pass.uncut.empty()) return fmt::format("pass {}: a step is not cut", pass.pass);
  }
  for (const LinkMove& gap : plan.gaps)
    if (!gap.planned) return fmt::format("the way to pass {}: {}", gap.to_pass, gap.detail);
  PlanResult slower = plan;
  for (const SlowStretch& slow : ReduceFeeds(slower).slow)
    if (slow.Share() < inputs.job.min_feed_share)
      return fmt::format("pass {}: the feed falls to {:.0f} %", slow.pass, 100 * slow.Share());
  return "";
}

}  // namespace

TriedJob TryJob(const JobInputs& given, size_t most_points, const CheckpointStore& checkpoints,
                const Execution& execution) {
  constexpr double kCoarseStep = DegToRad(2), kCoarseSweep = 2;  // rad; mm
  JobInputs inputs = given;
  inputs.job.path.rotation_step = std::max(inputs.job.path.rotation_step, kCoarseStep);
  inputs.job.swept_resolution = std::max(inputs.job.swept_resolution, kCoarseSweep);
  Trial trial{std::max<size_t>(most_points, 1)};
  PreparedJob prepared = WithPlaces(inputs, [&] { return Prepare(inputs, checkpoints, execution, &trial); });
  TriedJob tried;
  tried.of_passes = prepared.toolpath.passes.size();
  tried.of_points = trial.laid;
  const Share sample{0, std::clamp<size_t>((CountPoints(prepared.toolpath) + trial.most - 1) / trial.most, 1,
                                           std::max<size_t>(tried.of_passes, 1))};
  std::vector<PassResult> passes = PlanPassesOf(inputs, prepared, sample, checkpoints, execution).passes;
  const LinkMoveOptions options = MakeLinkMoveOptions(inputs.job);
  // Other poses at the ends are looked for only where those found lead nowhere: else they gain clearance
  // alone.
  for (const bool repair : {false, true}) {
    if (repair)
      RepairEnds({prepared.stations, prepared.toolpath, prepared.external}, MakePathOptions(inputs.job),
                 options.leave, checkpoints, execution, passes);
    PlanResult plan = StartPlan(inputs, prepared);
    plan.passes = passes;
    std::erase_if(plan.passes,
                  [](const PassResult& pass) { return pass.points.empty(); });  // not in the sample
    FixRevolutions(inputs, prepared.problem, plan);
    execution.progress.Begin("gaps", LinkMoveEnds(HomeOf(plan), plan.passes).size());
    plan.gaps = PlanAllLinkMoves(prepared.stations, plan.passes, options, checkpoints, execution).gaps;
    execution.progress.End(fmt::format("{} gaps", plan.gaps.size()));
    tried.passes = plan.passes.size();
    tried.points = CountPoints(plan);
    tried.problem = ProblemOf(inputs, prepared, plan);
    if (tried.problem.empty() || !prepared.made.findings.empty()) break;
  }
  return tried;
}

void PlanShare(const JobInputs& inputs, const Share& share, const CheckpointStore& checkpoints,
               const Execution& execution) {
  PreparedJob prepared = PrepareJob(inputs, checkpoints, execution);
  PlanPassesOf(inputs, prepared, share, checkpoints, execution);
}

}  // namespace millpose
