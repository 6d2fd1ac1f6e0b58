// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/repair_ends.hpp"

#include "base/counted.hpp"
#include "base/parallel.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"

namespace millpose {
namespace {

/// What a pass gives up at its ends.
struct EndLoss {
  size_t points = 0;   ///< skipped, or of pieces that cannot be entered or left at all
  size_t pieces = 0;   ///< of all
  size_t reduced = 0;  ///< ends that are left with less than all of the clearances
};

EndLoss LossOf(const Stations& stations, const RetractOptions& leave, const PassResult& pass) {
  EndLoss loss;
  loss.pieces = pass.pieces.size();
  loss.points = CountSkipped(pass);
  for (const Segment& piece : pass.pieces) {
    const auto share = [&](int point) {
      const auto t = static_cast<size_t>(point);
      const std::shared_ptr<const Station> station = stations.Of(pass, t);
      const PoseProblem& problem = station->problem;
      const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
      return ShareToLeave(station->world, carrier, pass.points[t].q, leave);
    };
    const double first = share(piece.first), last = piece.closed ? 1 : share(piece.last);
    if (first == 0 || last == 0) loss.points += static_cast<size_t>(piece.last - piece.first) + 1;
    loss.reduced += (first < 1) + (last < 1);
  }
  return loss;
}

bool IsBetter(const EndLoss& now, const EndLoss& before) {
  if (now.points != before.points) return now.points < before.points;
  return now.pieces <= before.pieces && now.reduced < before.reduced;
}

}  // namespace

void RepairEnds(const PassesWithEnds& of, PathOptions options, const RetractOptions& leave,
                const CheckpointStore& checkpoints, const Execution& execution,
                std::vector<PassResult>& passes) {
  execution.progress.Begin("ends", passes.size());
  const auto losses_in = [&](const Stations& stations) {
    std::vector<EndLoss> losses(passes.size());
    ParallelFor(passes.size(), execution.Threads(), execution.stop, [&](size_t i) {
      losses[i] = LossOf(stations, leave, passes[i]);
      execution.progress.Advance(1);
    });
    return losses;
  };
  const std::string key = StageKey(of.stations.problem(), leave, KeyOf(passes, execution.Threads()));
  const auto before = CachedInWorld<std::vector<EndLoss>>(checkpoints, of.stage, key, of.stations, losses_in);
  const auto stuck = [&](size_t i) { return before[i].reduced > 0; };
  const auto count = std::ranges::count_if(before, [](const EndLoss& loss) { return loss.reduced > 0; });
  execution.progress.End(fmt::format("{} with an end near something", CountedPasses(count)));
  if (count == 0) return;
  size_t points = 0, repaired = 0;
  for (size_t i = 0; i < passes.size(); ++i)
    if (stuck(i)) points += of.toolpath.passes[i].points.size();
  execution.progress.Begin("passes again", points);
  options.leave = leave;
  PlannedPasses again =
      PlanPasses(of.stations, {of.toolpath, of.external, stuck}, options, checkpoints, execution);
  for (size_t i = 0; i < passes.size(); ++i) {
    if (!stuck(i) || !IsBetter(LossOf(of.stations, leave, again.passes[i]), before[i])) continue;
    passes[i] = std::move(again.passes[i]);
    ++repaired;
  }
  execution.progress.End(fmt::format("{} of them with other poses at their ends", repaired));
}

}  // namespace millpose
