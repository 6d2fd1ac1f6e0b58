// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan_passes.hpp"

#include <atomic>
#include <map>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "path/nominal_plan.hpp"
#include "path/station_gap.hpp"
#include "pipeline/checkpoint_key.hpp"

namespace millpose {
namespace {

// What `parse` reads from the checkpoint, if there is one and it is what was asked for. One that cannot be
// read is as good as none.
template <class Result>
std::optional<Result> Resume(const CheckpointStore& checkpoints, const std::string& key,
                             Result (*parse)(std::string_view, const std::string&),
                             const std::function<bool(const Result&)>& fits) {
  const std::optional<std::string> bytes = checkpoints.Read(key);
  if (!bytes) return std::nullopt;
  try {
    Result result = parse(*bytes, key);
    if (!fits(result)) return std::nullopt;
    return result;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

PlannedPasses PlanPasses(const Stations& stations, const std::vector<ExternalPosition>& external,
                         const Toolpath& toolpath, const PathOptions& options,
                         const CheckpointStore& checkpoints, const std::function<bool(size_t)>& wanted,
                         const Execution& execution) {
  const int threads = execution.Threads();
  const size_t count = toolpath.passes.size();
  std::map<ExternalPosition, std::string> contexts;
  for (size_t i = 0; i < count; ++i) {
    if (!wanted(i)) continue;
    std::string& context = contexts[external[i]];
    const Station& station = stations.At(external[i]);
    if (context.empty()) context = PassContext(station.problem, station.world, options);
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
    const std::string key = PassKey(contexts.at(external[i]), pass, i, first_points[i]);
    const auto fits = [&](const PassResult& plan) {
      return IsPlanOf(AtNominalLean(stations.problem(), plan), pass, i);
    };
    if (auto earlier = Resume<PassResult>(checkpoints, key, ParsePassResult, fits)) {
      planned.passes[i] = std::move(*earlier);
      ++resumed;
    } else {
      const Station& station = stations.At(external[i]);
      planned.passes[i] = PlanPass(station.problem, station.world, pass, static_cast<int>(i), first_points[i],
                                   options, inner_threads, execution.stop);
      planned.passes[i].external = external[i];
      checkpoints.Write(key, Serialise(planned.passes[i]));
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
    const auto fits = [&](const Gap& gap) { return IsGapOf(gap, from, to); };
    if (auto earlier = Resume<Gap>(checkpoints, key, ParseGap, fits)) {
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
