// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/finer_passes.hpp"

#include "base/counted.hpp"
#include "job/assemble.hpp"
#include "job/job_engagement.hpp"
#include "planning/pass/large_steps.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "planning/result/pass_value.hpp"
#include "run/pipeline/stages/plan_passes.hpp"
#include "store/cached_stage.hpp"
#include "toolpath/pass_variants.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr int kMostParts = 16;           // that a step as laid is cut into
constexpr double kGainOfPoints = 0.005;  // of a pass's objective, that inserted points must be worth
constexpr double kNoPrice = 0.03;  // of its free optima: what continuity may cost without a search for more

/// What a pass pays for being one motion, as a share of what its points could have.
double PriceOf(const PassResult& pass) {
  double planned = 0, free = 0;
  for (const PlannedPoint& point : pass.points) {
    if (point.skip != Infeasibility::kNone) continue;
    planned += point.objective;
    free += point.free_optimum;
  }
  return free > 0 ? planned / free - 1 : 0;
}

/// Whether points are skipped because no step joins them to others.
bool HasUnjoined(const PassResult& pass) {
  return std::ranges::any_of(pass.points,
                             [](const PlannedPoint& point) { return point.skip == Infeasibility::kStep; });
}

/// Of rings only those that lose points are worth what a closed search costs.
bool CouldGain(const Pass& laid, const PassResult& pass) {
  return HasUnjoined(pass) || (!laid.closed && (pass.pieces.size() > 1 || PriceOf(pass) > kNoPrice));
}

/// The tool path in P, every step of the passes that `open` names cut into `parts`; those that are `turned`
/// run from the other end than strategies lay them.
Toolpath LayInParts(const PreparedJob& prepared, int parts, const std::vector<char>& open,
                    const Execution& execution) {
  const LayingInputs& laying = prepared.laying;
  const JobInputs& inputs = laying.inputs;
  JobToolpath made = MakeJobToolpath(inputs, laying.mesh, execution.stop, parts, execution.Threads()),
              checked;
  Toolpath whole = prepared.made.toolpath;
  if (made.toolpath.passes.size() != open.size()) return whole;
  for (size_t i = 0; i < open.size(); ++i)
    if (open[i] != 0) checked.toolpath.passes.push_back(std::move(made.toolpath.passes[i]));
  CheckJobGouges(inputs, laying.mesh, execution, checked);
  std::vector<std::vector<char>> points(open.size());
  for (size_t i = 0, k = 0; i < open.size(); ++i) {
    if (open[i] != 0) {
      const Pass& pass = checked.toolpath.passes[k++];
      whole.passes[i] = prepared.turned[i] != 0 ? RunFromEnd(pass) : pass;
    }
    points[i].assign(whole.passes[i].points.size(), open[i]);
  }
  SetEngagementOf(points, inputs, laying.mesh, execution, whole);
  return whole;
}

}  // namespace

void PlanFiner(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
               const std::function<bool(size_t)>& wanted, const Execution& execution,
               std::vector<PassResult>& passes) {
  if (!inputs.job.toolpath.strategy->File().empty()) return;
  const PathOptions options = MakePathOptions(inputs.job);
  // Against a bound per step more points help in the end, even if twice as many do not.
  const bool steps_bounded = std::isfinite(options.steps.most.minCoeff());
  const auto value = [&](const PassResult& pass) { return ValueOf(AtNominalLean(prepared.problem, pass)); };
  std::vector<char> open(passes.size(), 0);
  std::vector<PassResult> plans(passes.size());  // of what was tried last, where it is open
  for (size_t i = 0; i < passes.size(); ++i) {
    // What is laid closer together has other arc lengths, and moving axes would be elsewhere.
    open[i] = wanted(i) && !prepared.external[i].Moves() && CouldGain(prepared.toolpath.passes[i], passes[i])
                  ? 1
                  : 0;
    if (open[i] != 0) plans[i] = passes[i];
  }
  if (std::ranges::count(open, 1) == 0) return;
  Toolpath tried = prepared.toolpath;
  for (int parts = 2; parts <= kMostParts; parts *= 2) {
    std::vector<std::vector<char>> large(passes.size());
    size_t points = 0;
    for (size_t i = 0; i < passes.size(); ++i) {
      if (open[i] == 0) continue;
      const PoseProblem& problem = prepared.stations.At(prepared.external[i].from).problem;
      const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
      large[i] = LargeSteps(carrier, tried.passes[i], AtNominalLean(problem, plans[i]), options);
      open[i] = std::ranges::count(large[i], 1) > 0 ? 1 : 0;
      if (open[i] != 0) points += plans[i].points.size();
    }
    if (points == 0) return;
    execution.progress.Begin("finer passes", points);
    const Toolpath finer = AtStations(
        inputs,
        Cached<Toolpath>(checkpoints, fmt::format("finer-{}", parts),
                         StageKey(prepared.laying.key, prepared.made.toolpath, prepared.turned, parts, open),
                         [&] { return LayInParts(prepared, parts, open, execution); }),
        prepared.stations, prepared.external);
    for (size_t i = 0; i < passes.size(); ++i)
      if (open[i] != 0) tried.passes[i] = WithPointsBetween(tried.passes[i], finer.passes[i], large[i]);
    PlannedPasses again =
        PlanPasses(prepared.stations, {tried, prepared.external, [&](size_t i) { return open[i] != 0; }},
                   options, checkpoints, execution);
    size_t kept = 0, inserted = 0;
    for (size_t i = 0; i < passes.size(); ++i) {
      if (open[i] == 0) continue;
      plans[i] = std::move(again.passes[i]);
      const bool better = IsBetter(value(plans[i]), value(passes[i]), options.worst_first, kGainOfPoints);
      open[i] = better || (steps_bounded && HasUnjoined(plans[i])) ? 1 : 0;
      if (!better) continue;
      inserted += tried.passes[i].points.size() - prepared.toolpath.passes[i].points.size();
      passes[i] = plans[i];
      prepared.toolpath.passes[i] = tried.passes[i];
      ++kept;
    }
    execution.progress.End(fmt::format("{} points inserted in {}", inserted, CountedPasses(kept)));
    if (kept > 0)
      prepared.warnings.push_back(fmt::format(
          "toolpath: {} points are inserted in {}, where steps of the joints between points laid {:g} "
          "mm apart were too large (toolpath.spacing_mm)",
          inserted, CountedPasses(kept), 2 * inputs.job.toolpath.spacing / parts));
  }
}

}  // namespace millpose
