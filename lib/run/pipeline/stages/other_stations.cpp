// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/other_stations.hpp"

#include "base/counted.hpp"
#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "planning/pose/candidate_table.hpp"
#include "planning/pose/search.hpp"
#include "planning/result/pass_value.hpp"
#include "planning/result/skipped.hpp"
#include "run/pipeline/stages/plan_passes.hpp"

namespace millpose {
namespace {

constexpr double kJoined = 1.1;  // times its own optimum, that the worst point of a pass may have
/// Share of a pass's objective that another station, or moving along, must be worth.
constexpr double kGainElsewhere = 0.005;

/// Points that another station could serve: a gouge is one everywhere.
bool LosesPoints(const PassResult& pass) {
  return std::ranges::any_of(pass.points, [](const PlannedPoint& point) {
    return point.skip != Infeasibility::kNone && point.skip != Infeasibility::kGouge;
  });
}

/// Whether joining its poses costs the worst point of a pass much: the scores that stations are chosen by
/// know nothing of that.
bool PaysForJoining(const PassResult& pass) {
  const PlannedPoint* worst = nullptr;
  for (const PlannedPoint& point : pass.points)
    if (point.skip == Infeasibility::kNone && (!worst || point.objective > worst->objective)) worst = &point;
  return worst && worst->own_optimum > 0 && worst->objective > kJoined * worst->own_optimum;
}

/// Axes that move along a pass cost accuracy: they do so only where that makes the plan better than the one
/// at the best station that stands, which comes first.
bool MustEarnIt(const ExternalCourse& course, const std::vector<ExternalCourse>& next, size_t round) {
  return course.Moves() && round < next.size() && !next[round].Moves() && round == 0;
}

/// Whether the worst of a pass that is planned whole `here` cannot be as low at another station, because one
/// point alone (`placed`: with the part as it stands there) has no pose that good: then nothing needs to be
/// planned. With leans a point's own search may miss its optimum, so it proves nothing.
bool LosesThere(const Station& there, const Pass& placed, const PassResult& here,
                const PathOptions& options) {
  const PassValue value = ValueOf(here);
  const PoseProblem& problem = there.problem;
  if (!options.worst_first || problem.freedoms.size() > 1 || value.skipped > 0 || value.pieces > 1)
    return false;
  const double limit = value.worst * (1 + kGainElsewhere);
  return std::ranges::any_of(placed.points, [&](const MillingPoint& point) {
    if (point.kind != PointKind::kCut || point.gouge > 0) return false;
    const PointScorer scorer(problem, point, placed.rotation_reference);
    const PointOptimum best = RefineTable(scorer, CandidateTable::OfStep(scorer, options.rotation_step));
    return best.found && best.objective > limit;
  });
}

}  // namespace

void PlanOtherStations(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                       const std::function<bool(size_t)>& wanted, const Execution& execution,
                       std::vector<PassResult>& passes) {
  const PathOptions options = MakePathOptions(inputs.job);
  const auto& next = prepared.elsewhere;
  size_t moved = 0, tried = 0;
  for (size_t round = 0;; ++round) {
    std::vector<char> again(passes.size(), 0);
    size_t points = 0;
    std::vector<ExternalCourse> external = prepared.external;
    for (size_t i = 0; i < next.size(); ++i) {
      const bool poor = LosesPoints(passes[i]) || (options.worst_first && PaysForJoining(passes[i])) ||
                        MustEarnIt(prepared.external[i], next[i], round);
      again[i] = wanted(i) && round < next[i].size() && poor ? 1 : 0;
      if (again[i] == 0) continue;
      external[i] = next[i][round];
      points += prepared.toolpath.passes[i].points.size();
    }
    if (points == 0) break;
    if (tried == 0) execution.progress.Begin("other stations", points);
    tried += points;
    const Toolpath placed = AtStations(inputs, prepared.made.toolpath, prepared.stations, external);
    ParallelFor(next.size(), execution.Threads(), execution.stop, [&](size_t i) {
      if (again[i] == 0 || external[i].Moves() || prepared.external[i].Moves() ||
          !LosesThere(prepared.stations.At(external[i].from), placed.passes[i], passes[i], options))
        return;
      again[i] = 0;
      execution.progress.Advance(placed.passes[i].points.size());
    });
    PlannedPasses planned =
        PlanPasses(prepared.stations, {placed, external, [&](size_t i) { return again[i] != 0; }}, options,
                   checkpoints, execution);
    for (size_t i = 0; i < next.size(); ++i) {
      if (again[i] == 0) continue;
      const PassValue here = ValueOf(passes[i]), there = ValueOf(planned.passes[i]);
      const bool stays = MustEarnIt(prepared.external[i], next[i], round)
                             ? IsBetter(here, there, options.worst_first, kGainElsewhere)
                             : !IsBetter(there, here, options.worst_first, kGainElsewhere);
      if (stays) continue;
      passes[i] = std::move(planned.passes[i]);
      prepared.toolpath.passes[i] = placed.passes[i];
      prepared.external[i] = external[i];
      ++moved;
    }
  }
  if (tried > 0) execution.progress.End(fmt::format("{} moved to another station", CountedPasses(moved)));
}

}  // namespace millpose
