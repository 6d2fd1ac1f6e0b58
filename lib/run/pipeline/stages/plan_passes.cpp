// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_passes.hpp"

#include <atomic>
#include <map>

#include "base/parallel.hpp"
#include "planning/links/station_link_move.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "store/cached_pass.hpp"
#include "store/checkpoint_key.hpp"

namespace millpose {
namespace {

// Plans a gap; where the cell has no external axes `keeper` is told what was asked.
LinkMove PlanWatched(const Stations& stations, const std::pair<LinkMoveEnd, LinkMoveEnd>& ends,
                     const LinkMoveOptions& options, const std::shared_ptr<QueryLog>& keeper,
                     const std::stop_token& stop) {
  if (!stations.world().cell().external_axes.empty())
    return PlanStationLinkMove(stations, ends.first, ends.second, options, stop);
  return PlanLinkMove(stations.world().Recording(keeper), ends.first, ends.second, options, stop);
}

// What all passes at one station share.
struct AtStation {
  std::string context;
  Obstacles obstacles;
};

}  // namespace

PlannedPasses PlanPasses(const Stations& stations, const PassesToPlan& request, const PathOptions& options,
                         const CheckpointStore& checkpoints, const Execution& execution) {
  const Toolpath& toolpath = request.toolpath;
  const std::vector<ExternalCourse>& external = request.external;
  const int threads = execution.Threads();
  const size_t count = toolpath.passes.size();
  std::map<ExternalPosition, AtStation> at;
  for (size_t i = 0; i < count; ++i) {
    if (!request.wanted(i) || external[i].Moves() || at.contains(external[i].from)) continue;
    const Station& station = stations.At(external[i].from);
    at[external[i].from] = {PassContext(station.problem, station.world, options),
                            ObstaclesOf(station.world.cell())};
  }
  const std::string riding = CoordinatedContext(stations.problem(), stations.world(), options);
  std::vector<size_t> first_points(count, 0);
  for (size_t i = 1; i < count; ++i)
    first_points[i] = first_points[i - 1] + toolpath.passes[i - 1].points.size();

  // A job of few passes spends its threads inside them.
  const Execution inner{
      count >= static_cast<size_t>(threads) ? 1 : threads, execution.progress, execution.stop,
      execution.Memory() / static_cast<double>(std::clamp<size_t>(count, 1, std::max(1, threads)))};
  PlannedPasses planned;
  planned.passes.resize(count);
  std::atomic<size_t> resumed = 0;
  ParallelFor(count, threads, execution.stop, [&](size_t i) {
    if (!request.wanted(i)) return;
    const Pass& pass = toolpath.passes[i];
    const PassToPlan wanted{pass, static_cast<int>(i), first_points[i]};
    const bool moves = external[i].Moves();
    const AtStation none{CoordinatedKey(riding, external[i]), {}};
    const AtStation& shared = moves ? none : at.at(external[i].from);
    const std::string key = PassKey(shared.context, pass, i, first_points[i]);
    const auto fits = [&](const PassResult& plan) {
      return IsPlanOf(AtNominalLean(stations.problem(), plan), pass, i);
    };
    // Where axes move nobody notes what was asked about obstacles: they are all in the key.
    const World& world = moves ? stations.world() : stations.At(external[i].from).world;
    if (auto earlier = ReadPass(checkpoints, key, world, shared.obstacles, pass, fits)) {
      planned.passes[i] = std::move(*earlier);
      ++resumed;
    } else if (moves) {
      const std::vector<ExternalPosition> positions = PositionsAlong(external[i], pass);
      planned.passes[i] = PlanPass({stations, positions}, wanted, options, inner);
      WritePass(checkpoints, key, shared.obstacles, {}, pass, planned.passes[i]);
    } else {
      const Station& station = stations.At(external[i].from);
      const auto looks = std::make_shared<QueryLog>();
      planned.passes[i] = PlanPass(station.problem, station.world.Recording(looks), wanted, options, inner);
      planned.passes[i].external = external[i].from;
      WritePass(checkpoints, key, shared.obstacles, looks->Collected(), pass, planned.passes[i]);
    }
    execution.progress.Advance(pass.points.size());
  });
  planned.resumed = resumed;
  return planned;
}

PlannedLinkMoves PlanLinkMoves(const Stations& stations,
                               const std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>>& ends,
                               const LinkMoveOptions& options, const CheckpointStore& checkpoints,
                               const Execution& execution) {
  const World& world = stations.world();
  const std::string context = LinkMoveContext(world, options);
  const Obstacles obstacles = ObstaclesOf(world.cell());
  PlannedLinkMoves planned;
  planned.gaps.resize(ends.size());
  std::atomic<size_t> resumed = 0;
  ParallelFor(ends.size(), execution.Threads(), execution.stop, [&](size_t i) {
    const LinkMoveEnd &from = ends[i].first, &to = ends[i].second;
    const std::string key = LinkMoveKey(context, from, to);
    const auto fits = [&](const LinkMove& gap) { return IsLinkMoveOf(gap, from, to); };
    if (auto earlier = ReadLinkMove(checkpoints, key, world, obstacles, fits)) {
      planned.gaps[i] = std::move(*earlier);
      ++resumed;
    } else {
      const auto looks = std::make_shared<QueryLog>();
      planned.gaps[i] = PlanWatched(stations, ends[i], options, looks, execution.stop);
      WriteLinkMove(checkpoints, key, obstacles, looks->Collected(), planned.gaps[i]);
    }
    execution.progress.Advance(1);
  });
  planned.resumed = resumed;
  return planned;
}

}  // namespace millpose
