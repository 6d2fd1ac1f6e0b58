// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_faces.hpp"

#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "planning/pass/face_planner.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"

namespace millpose {

void PlanFaces(const JobInputs& inputs, const PreparedJob& prepared, const CheckpointStore& checkpoints,
               const Execution& execution, std::vector<PassResult>& passes) {
  if (!prepared.problem.objective->JudgesFace()) return;
  FaceOptions options{MakeGearModel(inputs.cell), MakePathOptions(inputs.job),
                      MakeLinkMoveOptions(inputs.job).leave};
  execution.progress.Begin("faces", passes.size());
  const int threads = execution.Threads();
  // A job of few passes spends its threads inside them.
  const Execution inner{passes.size() >= static_cast<size_t>(threads) ? 1 : threads, execution.progress,
                        execution.stop, execution.Memory()};
  ParallelFor(passes.size(), threads, execution.stop, [&](size_t i) {
    const std::string key = StageKey(prepared.problem, options, KeyOf(std::vector{passes[i]}, 1));
    passes[i] = CachedInWorld<PassResult>(
        checkpoints, fmt::format("face-{}", i), key, prepared.stations,
        [&](const Stations& stations) { return PlanFace(stations, passes[i], options, inner); });
    execution.progress.Advance(1);
  });
  execution.progress.End(fmt::format("{} passes", passes.size()));
}

}  // namespace millpose
