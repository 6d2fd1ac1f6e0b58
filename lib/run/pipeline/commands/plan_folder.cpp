// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/plan_folder.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "job/step_meshes.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

/// What is read here must be what the plan wrote.
void CheckOwnFiles(const std::filesystem::path& folder, const FileRoot& root) {
  const std::filesystem::path file = folder / kManifestFile;
  const Manifest manifest = ParseManifest(root.Read(file), file.string());
  std::vector<Problem> problems;
  for (const char* name : {kPlanFile, "job.yaml", "cell.yaml", "summary.json"}) {
    const auto listed = manifest.files.find(name);
    if (listed == manifest.files.end())
      problems.push_back(
          {{file.string()}, fmt::format("lists no {}; allowed: a folder of millpose plan", name)});
    else if (Hash(root.Read(folder / name)) != listed->second.hash)
      problems.push_back({{(folder / name).string()}, "was changed or is of another plan (manifest.json)"});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace

PlanFolder ReadPlanFolder(const std::filesystem::path& folder,
                          const std::optional<std::filesystem::path>& job, const FileRoot& root,
                          PlanFiles files) {
  PlanFolder read;
  root.CheckFolder(folder);
  ReadWhole(folder, [&] {
    RefuseSeveral(folder);
    if (files == PlanFiles::kAsWritten) CheckOwnFiles(folder, root);
    read.plan = ReadPlanIn(folder, root);
    read.summary = root.Read(folder / "summary.json");
    std::optional<std::filesystem::path> origin;
    if (job) origin = std::filesystem::absolute(*job).parent_path();
    read.inputs = LoadJobInputs(folder / "job.yaml", {}, origin, root);
    TakeCachedMeshes(folder, &read.inputs);
  });
  return read;
}

}  // namespace millpose
