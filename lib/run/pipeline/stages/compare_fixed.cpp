// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/compare_fixed.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/compared.hpp"
#include "store/cached_stage.hpp"

namespace millpose {
namespace {

/// How much is known; it only grows.
size_t Known(const FixedOfPass& of) {
  return of.tables.size() +
         static_cast<size_t>(std::ranges::count_if(of.free, [](char c) { return c != 0; }));
}

/// What all passes of a job are handed besides themselves. Which rotation is the best, and what the gears do,
/// is worked out each time.
std::string ContextOf(const FixedRotationOptions& options, const std::vector<PassResult>& passes,
                      const Stations& stations) {
  // Every field has its name here, so that one that is added cannot be forgotten.
  const auto& [rotation_step, steps, swept_resolution, worst_first, gears, finished_from, threads, stop,
               leave] = options;
  const Cell& cell = stations.world().cell();
  return StageKey(std::string("fixed"), stations.problem(), rotation_step, steps, swept_resolution, leave,
                  MaterialIsKnown(passes),
                  HashOfValues(cell.external_axes.empty() ? WithoutPlaces(cell) : cell));
}

}  // namespace

FixedComparison CompareFixed(const JobInputs& inputs, const PreparedJob& prepared,
                             const std::vector<PassResult>& passes, const CheckpointStore& checkpoints,
                             const Execution& execution) {
  const FixedRotationOptions options =
      MakeFixedOptions(inputs.job, inputs.cell, passes.size(), execution.Threads(), execution.stop);
  const Stations stations = prepared.stations.AtOwnAxis();
  const World& world = stations.world();
  // Where there are external axes nobody notes what was asked about obstacles: they are all in the key.
  const bool watched = world.cell().external_axes.empty();
  const Obstacles obstacles = watched ? ObstaclesOf(world.cell()) : Obstacles();
  std::vector<PassResult> upright;
  if (HasLean(prepared.problem))
    for (const PassResult& pass : passes) upright.push_back(AtNominalLean(prepared.problem, pass));
  const std::vector<PassResult>& nominal = HasLean(prepared.problem) ? upright : passes;
  const std::string context = ContextOf(options, nominal, stations);
  std::vector<FixedPass> of_passes(passes.size(), {stations, {}});
  struct Before {
    std::string stage, key;
    size_t known = 0;
    std::shared_ptr<QueryLog> looks = std::make_shared<QueryLog>();  ///< of all that is known
  };
  std::vector<Before> before(passes.size());
  ParallelFor(passes.size(), options.threads, options.stop, [&](size_t i) {
    Before& of = before[i];
    of.stage = fmt::format("fixed-{}", i);
    of.key = HashOfValues(context, nominal[i]);
    if (watched) of_passes[i].stations = Stations(world.Recording(of.looks), stations.problem());
    auto kept = ReadInWorld<FixedOfPass>(checkpoints, of.stage, of.key, world, obstacles);
    if (!kept) return;
    of.looks->Take(kept->asked.looks);
    of.known = Known(kept->result);
    of_passes[i].known = std::move(kept->result);
  });
  FixedComparison comparison = CompareWithFixed(stations, nominal, options, of_passes);
  ParallelFor(passes.size(), options.threads, options.stop, [&](size_t i) {
    const Before& of = before[i];
    if (Known(of_passes[i].known) == of.known) return;
    const MadeInWorld<FixedOfPass> made{{obstacles, of.looks->Collected()}, std::move(of_passes[i].known)};
    checkpoints.WriteStage(of.stage, of.key, ValueBytes().Add(made).bytes());
  });
  return comparison;
}

}  // namespace millpose
