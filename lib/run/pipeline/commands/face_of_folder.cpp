// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/face_of_folder.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

/// A plan's folder, of one set.
struct PlanFolder {
  PlanResult plan;
  JobInputs inputs;
  std::string summary;
};

PlanFolder ReadFolder(const FaceArguments& arguments) {
  PlanFolder read;
  arguments.root.CheckFolder(arguments.plan);
  ReadWhole(arguments.plan, [&] {
    RefuseSeveral(arguments.plan);
    const std::filesystem::path plan_file = arguments.plan / kPlanFile;
    read.plan = ParsePlanResult(arguments.root.Read(plan_file), plan_file.string());
    read.summary = arguments.root.Read(arguments.plan / "summary.json");
    std::optional<std::filesystem::path> origin;
    if (arguments.job) origin = std::filesystem::absolute(*arguments.job).parent_path();
    read.inputs = LoadJobInputs(arguments.plan / "job.yaml", {}, origin, arguments.root);
    TakeCachedMeshes(arguments.plan, &read.inputs);
  });
  return read;
}

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
  PlanFolder folder = ReadFolder(arguments);
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
