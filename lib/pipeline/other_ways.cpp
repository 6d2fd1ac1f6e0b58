// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/other_ways.hpp"

#include "base/parallel.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/job_engagement.hpp"
#include "pipeline/plan_passes.hpp"
#include "plan/pass_value.hpp"
#include "pose/search.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/pass_variants.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kGain = 0.05;  // of a pass's objective: less is not worth a longer way to the pass's start
constexpr int kSettings = 48;   // of the rotation, for the first look at what the other way promises

/// The objective at the points' own best poses.
struct Promise {
  double worst = 0, sum = 0;

  void Take(double objective) {
    worst = std::max(worst, objective);
    sum += objective;
  }
};

Promise PromiseOf(const PassResult& planned) {
  Promise promise;
  for (const PlannedPoint& point : planned.points)
    if (point.point.kind == PointKind::kCut) promise.Take(point.own_optimum);
  return promise;
}

Promise PromiseOf(const PoseProblem& problem, const Pass& pass) {
  Promise promise;
  for (const MillingPoint& point : pass.points) {
    if (point.kind != PointKind::kCut || point.gouge > 0) continue;
    const PointScorer scorer(problem, point, pass.rotation_reference);
    const PointOptimum best = RefineTable(scorer, CandidateTable::OfSize(scorer, kSettings));
    if (best.found) promise.Take(best.objective);
  }
  return promise;
}

/// The tool path in W with every pass that may be turned round run from its end.
Toolpath TurnedRound(const JobInputs& inputs, const PreparedJob& prepared, const Execution& execution) {
  Toolpath turned = prepared.toolpath;
  std::vector<char> reversible;
  for (Pass& pass : turned.passes) {
    reversible.push_back(pass.reversible ? 1 : 0);
    if (pass.reversible) pass = RunFromEnd(pass);
  }
  Toolpath on_part = Transformed(turned, prepared.cell.X_WP.inverse());
  SetEngagementOf(reversible, inputs, prepared.surface.mesh, execution, on_part);
  on_part = Transformed(on_part, prepared.cell.X_WP);
  for (size_t i = 0; i < turned.passes.size(); ++i)
    for (size_t t = 0; t < turned.passes[i].points.size(); ++t)
      turned.passes[i].points[t].engagement = on_part.passes[i].points[t].engagement;
  return turned;
}

}  // namespace

bool FreeDirections(const JobSettings& job) {
  const ToolpathSettings& toolpath = job.toolpath;
  const bool upright = toolpath.lead == 0 && toolpath.tilt == 0;
  return !toolpath.strategy->IsPrescribed() && upright && toolpath.direction == Direction::kZigzag;
}

bool DependsOnFeed(const JobSettings& job, const Objective& objective) {
  return job.cutting || objective.DependsOnFeed();
}

void PlanOtherWays(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                   const std::function<bool(size_t)>& wanted, const Execution& execution,
                   std::vector<PassResult>& passes) {
  if (!FreeDirections(inputs.job) || !prepared.problem.objective->DependsOnFeed()) return;
  const PathOptions options = MakePathOptions(inputs.job);
  const Toolpath turned = TurnedRound(inputs, prepared, execution);
  std::vector<char> promising(passes.size(), 0);
  ParallelFor(passes.size(), execution.Threads(), execution.stop, [&](size_t i) {
    if (!wanted(i) || !turned.passes[i].reversible) return;
    const Promise now = PromiseOf(passes[i]), other = PromiseOf(prepared.problem, turned.passes[i]);
    promising[i] =
        (options.worst_first && other.worst < now.worst * (1 - kGain)) || other.sum < now.sum * (1 - kGain);
  });
  size_t points = 0;
  for (size_t i = 0; i < passes.size(); ++i)
    if (promising[i] != 0) points += turned.passes[i].points.size();
  if (points == 0) return;
  execution.progress.Begin("other ways", points);
  PlannedPasses again = PlanPasses(
      prepared.problem, prepared.world, turned, options, checkpoints,
      [&](size_t i) { return promising[i] != 0; }, execution);
  std::vector<size_t> turns;
  for (size_t i = 0; i < passes.size(); ++i) {
    if (promising[i] == 0) continue;
    if (!IsBetter(ValueOf(again.passes[i]), ValueOf(passes[i]), options.worst_first, kGain)) continue;
    passes[i] = std::move(again.passes[i]);
    prepared.toolpath.passes[i] = turned.passes[i];
    turns.push_back(i);
  }
  execution.progress.End(fmt::format("{} passes run the other way round", turns.size()));
  if (!turns.empty())
    prepared.warnings.push_back(
        fmt::format("toolpath: passes {} run from their other end, where the force bends the arm less "
                    "(direction: zigzag leaves it open)",
                    fmt::join(turns, ", ")));
}

}  // namespace millpose
