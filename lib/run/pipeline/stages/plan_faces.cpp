// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_faces.hpp"

#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"

namespace millpose {

std::vector<FaceChoice> PlanFaces(const JobInputs& inputs, const PreparedJob& prepared,
                                  const CheckpointStore& checkpoints, const Execution& execution,
                                  std::vector<PassResult>& passes) {
  if (!prepared.problem.objective->JudgesFace()) return {};
  FacePlanOptions options{MakeGearModel(inputs.cell), MakePathOptions(inputs.job),
                          MakeLinkMoveOptions(inputs.job).leave};
  const int threads = execution.Threads();
  // A job of few passes spends its threads inside them.
  const Execution inner{passes.size() >= static_cast<size_t>(threads) ? 1 : threads, execution.progress,
                        execution.stop, execution.Memory()};
  const auto key = [&](size_t i) {
    return StageKey(prepared.problem, options, KeyOf(std::vector{passes[i]}, 1));
  };
  const auto first = static_cast<size_t>(FinishedFrom(inputs.job, passes.size()));
  execution.progress.Begin("faces", 2 * (passes.size() - first));
  std::vector<double> attainable(passes.size(), 0);
  ParallelFor(passes.size() - first, threads, execution.stop, [&](size_t k) {
    const size_t i = first + k;
    attainable[i] = CachedInWorld<double>(
        checkpoints, fmt::format("face-bound-{}", i), key(i), prepared.stations,
        [&](const Stations& stations) { return AttainableFace(stations, passes[i], options, inner); });
    execution.progress.Advance(1);
  });
  for (const double one : attainable) options.limit = std::max(options.limit, one);
  std::vector<std::vector<FaceChoice>> choices(passes.size());
  ParallelFor(passes.size() - first, threads, execution.stop, [&](size_t k) {
    const size_t i = first + k;
    PlannedFace planned = CachedInWorld<PlannedFace>(
        checkpoints, fmt::format("face-{}", i), key(i), prepared.stations,
        [&](const Stations& stations) { return PlanFace(stations, passes[i], options, inner); });
    passes[i] = std::move(planned.pass);
    choices[i] = std::move(planned.choices);
    execution.progress.Advance(1);
  });
  std::vector<FaceChoice> all;
  for (const auto& of_pass : choices) all.insert(all.end(), of_pass.begin(), of_pass.end());
  execution.progress.End(fmt::format(
      "{} of {} pieces moved",
      std::ranges::count_if(all, [](const FaceChoice& choice) { return choice.way != FaceWay::kPlanned; }),
      all.size()));
  return all;
}

}  // namespace millpose
