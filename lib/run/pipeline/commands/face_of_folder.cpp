// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/face_of_folder.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "run/pipeline/commands/plan_folder.hpp"

namespace millpose {
namespace {

/// The best fixed rotation of the job, or why there is none, as the plan found them.
void TakeFixedRotation(const PlanFolder& folder, const std::string& name, FaceOptions& options) {
  try {
    const auto fixed = nlohmann::json::parse(folder.summary).at("fixed_rotation");
    if (fixed.is_null()) return;
    if (const auto& job = fixed.at("job"); !job.is_null())
      options.rotation = DegToRad(job.at("rotation_deg").get<double>());
    else if (const auto& why = fixed.at("in_the_way").at("job"); why.is_string())
      options.fixed_in_the_way = why.get<std::string>();
  } catch (const nlohmann::json::exception&) {
    throw InputError({name}, "is no summary that millpose plan wrote");
  }
}

}  // namespace

FaceReport FaceOfFolder(const FaceArguments& arguments, const Execution& execution) {
  PlanFolder folder = ReadPlanFolder(arguments.plan, arguments.job, arguments.root, PlanFiles::kAsTheyStand);
  FaceOptions options = arguments.options;
  if (!options.rotation) TakeFixedRotation(folder, (arguments.plan / "summary.json").string(), options);
  CutStepFiles(
      &folder.inputs, [](int) {}, execution.stop);
  CellSettings settings = folder.inputs.cell;
  settings.bodies.clear();  // no pose of the plan is looked at for interference here
  const Cell bare = MakeCell(settings, {});
  const Stations stations(World(bare), MakePoseProblem(folder.inputs.job, settings, bare));
  const Part part = ReadPart(folder.inputs, bare);
  return PredictFace(folder.inputs, folder.plan, part.import.mesh, stations.AtOwnAxis(), options, execution);
}

}  // namespace millpose
