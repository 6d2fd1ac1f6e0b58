// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/lay_path.hpp"

#include "base/counted.hpp"
#include "job/job_engagement.hpp"
#include "job/narrow_inputs.hpp"
#include "store/cached_stage.hpp"

namespace millpose {
namespace {

std::string Outcome(const Toolpath& toolpath) {
  return fmt::format("{} points in {}", CountPoints(toolpath), CountedPasses(toolpath.passes.size()));
}

std::string GougesOf(const LaidPathOfJob& laid) { return fmt::format("{} points", laid.made.gouges.points); }

LaidPathOfJob Lay(const LayingInputs& laying, const Execution& execution) {
  const JobInputs& inputs = laying.inputs;
  LaidPathOfJob laid;
  laid.made = MakeJobToolpath(inputs, laying.mesh, execution.stop, 1, execution.Threads());
  JobToolpath& made = laid.made;
  execution.progress.End(Outcome(made.toolpath));
  execution.progress.Begin("gouges", 0);
  CheckJobGouges(inputs, laying.mesh, execution, made);
  if (!inputs.job.cutting) return laid;
  execution.progress.End(GougesOf(laid));
  execution.progress.Begin("engagement", 0);
  laid.heaviest = SetJobEngagement(inputs, laying.mesh, execution, made.toolpath);
  return laid;
}

}  // namespace

LayingInputs MakeLayingInputs(const JobInputs& inputs, const Mesh& mesh) {
  LayingInputs laying{InputsOfToolpath(inputs), mesh, {}};
  laying.key =
      StageKey(laying.inputs.hash, laying.inputs.max_points, mesh.triangles(), laying.inputs.cut_before);
  return laying;
}

LaidPathOfJob LayPath(const LayingInputs& laying, const CheckpointStore& checkpoints,
                      const Execution& execution) {
  execution.progress.Begin("toolpath", 0);
  bool made = false;
  LaidPathOfJob laid = Cached<LaidPathOfJob>(checkpoints, "toolpath", laying.key, [&] {
    made = true;
    return Lay(laying, execution);
  });
  execution.progress.End(!made ? Outcome(laid.made.toolpath) + ", as laid before"
                         : laying.inputs.job.cutting
                             ? fmt::format("{} points", CountPoints(laid.made.toolpath))
                             : GougesOf(laid));
  return laid;
}

}  // namespace millpose
