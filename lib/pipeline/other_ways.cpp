// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/other_ways.hpp"

#include "base/parallel.hpp"
#include "path/nominal_plan.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/job_engagement.hpp"
#include "pipeline/kept_stage.hpp"
#include "pipeline/plan_passes.hpp"
#include "plan/pass_value.hpp"
#include "pose/lean_problem.hpp"
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

PointOptimum OwnOptimum(const PointScorer& scorer) {
  if (!HasLean(scorer.problem())) return RefineTable(scorer, CandidateTable::OfSize(scorer, kSettings));
  const PointOptimum best = RefineTable(scorer, CandidateTable::OfStep(scorer, 2 * kPi / kSettings));
  return best.found ? Descend(scorer, best) : best;
}

Promise PromiseOf(const PoseProblem& problem, const Pass& pass) {
  Promise promise;
  for (const MillingPoint& point : pass.points) {
    if (point.kind != PointKind::kCut || point.gouge > 0) continue;
    const PointScorer scorer(problem, point, pass.rotation_reference);
    const PointOptimum best = OwnOptimum(scorer);
    if (best.found) promise.Take(best.objective);
  }
  return promise;
}

/// Every pass that may be turned round run from its end, and what it promises then.
struct OtherWays {
  Toolpath turned;                ///< in W
  std::vector<Promise> promises;  ///< by pass; of those that may be turned and are wanted
};

OtherWays TurnRound(const PreparedJob& prepared, const std::vector<char>& wanted,
                    const Execution& execution) {
  const std::vector<Pass>& laid = prepared.toolpath.passes;
  OtherWays ways{prepared.toolpath, std::vector<Promise>(laid.size())};
  std::vector<char> reversible;
  for (Pass& pass : ways.turned.passes) {
    reversible.push_back(pass.reversible ? 1 : 0);
    if (pass.reversible) pass = RunFromEnd(pass);
  }
  const auto station = [&](size_t i) -> const Station& { return prepared.stations.At(prepared.external[i]); };
  const auto part = [&](size_t i) { return station(i).world.cell().X_WP; };
  Toolpath on_part = ways.turned;
  for (size_t i = 0; i < laid.size(); ++i) Transform(part(i).inverse(), on_part.passes[i]);
  SetEngagementOf(reversible, prepared.laying.inputs, prepared.laying.mesh, execution, on_part);
  for (size_t i = 0; i < laid.size(); ++i) Transform(part(i), on_part.passes[i]);
  ParallelFor(laid.size(), execution.Threads(), execution.stop, [&](size_t i) {
    Pass& pass = ways.turned.passes[i];
    for (size_t t = 0; t < pass.points.size(); ++t)
      pass.points[t].engagement = on_part.passes[i].points[t].engagement;
    if (wanted[i] != 0 && reversible[i] != 0) ways.promises[i] = PromiseOf(station(i).problem, pass);
  });
  return ways;
}

/// The same, or what it came to before.
OtherWays KeptWays(const PreparedJob& prepared, const std::vector<char>& wanted,
                   const CheckpointStore& checkpoints, const Execution& execution) {
  const Cell& cell = prepared.cell;
  const std::string key = StageKey(prepared.laying.key, prepared.toolpath, prepared.external,
                                   prepared.problem, cell.X_WP, cell.external_axes, wanted);
  return Kept<OtherWays>(checkpoints, "other-ways", key,
                         [&] { return TurnRound(prepared, wanted, execution); });
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
  std::vector<char> asked(passes.size());
  for (size_t i = 0; i < passes.size(); ++i) asked[i] = wanted(i) ? 1 : 0;
  const auto [turned, promises] = KeptWays(prepared, asked, checkpoints, execution);
  std::vector<char> promising(passes.size(), 0);
  for (size_t i = 0; i < passes.size(); ++i) {
    if (asked[i] == 0 || !turned.passes[i].reversible) continue;
    const Promise now = PromiseOf(passes[i]), &other = promises[i];
    promising[i] =
        (options.worst_first && other.worst < now.worst * (1 - kGain)) || other.sum < now.sum * (1 - kGain);
  }
  size_t points = 0;
  for (size_t i = 0; i < passes.size(); ++i)
    if (promising[i] != 0) points += turned.passes[i].points.size();
  if (points == 0) return;
  execution.progress.Begin("other ways", points);
  PlannedPasses again = PlanPasses(
      prepared.stations, prepared.external, turned, options, checkpoints,
      [&](size_t i) { return promising[i] != 0; }, execution);
  std::vector<size_t> turns;
  for (size_t i = 0; i < passes.size(); ++i) {
    if (promising[i] == 0) continue;
    const auto value = [&](const PassResult& pass) { return ValueOf(AtNominalLean(prepared.problem, pass)); };
    if (!IsBetter(value(again.passes[i]), value(passes[i]), options.worst_first, kGain)) continue;
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
