// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan_passes.hpp"

#include <atomic>
#include <map>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "path/nominal_plan.hpp"
#include "path/station_gap.hpp"
#include "pipeline/checkpoint_key.hpp"
#include "pipeline/kept_pass.hpp"

namespace millpose {
namespace {

// The gap kept under a key, if there is one and it is what was asked for. One that cannot be read is as good
// as none.
std::optional<Gap> ReadGap(const CheckpointStore& checkpoints, const std::string& key, const GapEnd& from,
                           const GapEnd& to) {
  const std::optional<std::string> bytes = checkpoints.Read(key);
  if (!bytes) return std::nullopt;
  try {
    Gap gap = ParseGap(*bytes, key);
    if (!IsGapOf(gap, from, to)) return std::nullopt;
    return gap;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// What all passes at one station share.
struct AtStation {
  std::string context;
  Obstacles obstacles;
};

}  // namespace

PlannedPasses PlanPasses(const Stations& stations, const std::vector<ExternalPosition>& external,
                         const Toolpath& toolpath, const PathOptions& options,
                         const CheckpointStore& checkpoints, const std::function<bool(size_t)>& wanted,
                         const Execution& execution) {
  const int threads = execution.Threads();
  const size_t count = toolpath.passes.size();
  std::map<ExternalPosition, AtStation> at;
  for (size_t i = 0; i < count; ++i) {
    if (!wanted(i) || at.contains(external[i])) continue;
    const Station& station = stations.At(external[i]);
    at[external[i]] = {PassContext(station.problem, station.world, options),
                       ObstaclesOf(station.world.cell())};
  }
  std::vector<size_t> first_points(count, 0);
  for (size_t i = 1; i < count; ++i)
    first_points[i] = first_points[i - 1] + toolpath.passes[i - 1].points.size();

  // A job of few passes spends its threads inside them.
  const int inner_threads = count >= static_cast<size_t>(threads) ? 1 : threads;
  PlannedPasses planned;
  planned.passes.resize(count);
  std::atomic<size_t> resumed = 0;
  ParallelFor(count, threads, execution.stop, [&](size_t i) {
    if (!wanted(i)) return;
    const Pass& pass = toolpath.passes[i];
    const AtStation& shared = at.at(external[i]);
    const std::string key = PassKey(shared.context, pass, i, first_points[i]);
    const Station& station = stations.At(external[i]);
    const auto fits = [&](const PassResult& plan) {
      return IsPlanOf(AtNominalLean(stations.problem(), plan), pass, i);
    };
    if (auto earlier = ReadPass(checkpoints, key, station.world, shared.obstacles, fits)) {
      planned.passes[i] = std::move(*earlier);
      ++resumed;
    } else {
      const auto looks = std::make_shared<LookKeeper>();
      planned.passes[i] = PlanPass(station.problem, station.world.Watched(looks), pass, static_cast<int>(i),
                                   first_points[i], options, inner_threads, execution.stop);
      planned.passes[i].external = external[i];
      WritePass(checkpoints, key, shared.obstacles, looks->Kept(), planned.passes[i]);
    }
    execution.progress.Advance(pass.points.size());
  });
  planned.resumed = resumed;
  return planned;
}

PlannedGaps PlanGaps(const Stations& stations, const std::vector<std::pair<GapEnd, GapEnd>>& ends,
                     const GapOptions& options, const CheckpointStore& checkpoints,
                     const Execution& execution) {
  const std::string context = GapContext(stations.world(), options);
  PlannedGaps planned;
  planned.gaps.resize(ends.size());
  std::atomic<size_t> resumed = 0;
  ParallelFor(ends.size(), execution.Threads(), execution.stop, [&](size_t i) {
    const GapEnd &from = ends[i].first, &to = ends[i].second;
    const std::string key = GapKey(context, from, to);
    if (auto earlier = ReadGap(checkpoints, key, from, to)) {
      planned.gaps[i] = std::move(*earlier);
      ++resumed;
    } else {
      planned.gaps[i] = PlanStationGap(stations, from, to, options, execution.stop);
      checkpoints.Write(key, Serialise(planned.gaps[i]));
    }
    execution.progress.Advance(1);
  });
  planned.resumed = resumed;
  return planned;
}

}  // namespace millpose
