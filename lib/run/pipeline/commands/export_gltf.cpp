// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/export_gltf.hpp"

#include "base/loose_file.hpp"
#include "job/assemble.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "report/gltf/cell_gltf.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"

namespace millpose {

ExportOutcome ExportGltf(const ExportArguments& arguments, const Execution& execution) {
  PlanFolder folder = ReadPlanFolder(arguments.plan, arguments.job, arguments.root);
  const Timeline timeline = PlanTimeline(folder.plan, folder.inputs);
  if (timeline.empty()) return {1, "nothing is written: no piece was planned\n"};
  CutStepFiles(
      &folder.inputs, [](int) {}, execution.stop);
  const Cell cell = MakeJobCell(folder.inputs);
  const std::string scene = CellGltf(cell, NamesFor(cell), folder.plan, timeline);
  WriteLooseFile(arguments.gltf, scene);
  return {0, fmt::format("scene        {} bodies, {:.1f} MB\n"
                         "animation    run, {:.3f} s, {} instants\n"
                         "written to {}\n",
                         cell.bodies.size(), static_cast<double>(scene.size()) / 1e6, timeline.back().time,
                         timeline.size(), arguments.gltf.string())};
}

}  // namespace millpose
