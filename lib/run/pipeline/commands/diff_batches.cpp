// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/diff_batches.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBatchFile = "batch.json";

/// Jobs of a batch that have a plan.
std::set<std::string> PlannedJobs(const fs::path& folder) {
  if (!IsBatchFolder(folder))
    throw InputError(
        {folder.string()},
        "is no output folder of millpose batch, as the other is; allowed: two plans, or two batches");
  try {
    std::set<std::string> names;
    const nlohmann::json batch = nlohmann::json::parse(Folder(folder).Read(kBatchFile));
    for (const nlohmann::json& job : batch.at("jobs")) {
      const std::string name = job.at("folder").get<std::string>();
      if (IsPlainName(name) && IsOutputFolder(folder / name) &&
          Folder(folder / name).KindOf("summary.json") == Folder::Kind::kFile)
        names.insert(name);
    }
    return names;
  } catch (const nlohmann::json::exception&) {
    throw InputError({(folder / kBatchFile).string()}, "is none that millpose batch wrote");
  }
}

Differences DiffJob(const DiffArguments& arguments, const std::string& name) {
  try {
    return DiffFolders({arguments.before / name, arguments.after / name, arguments.root});
  } catch (const InputError& error) {
    return {{{"findings", fmt::format("cannot be compared: {}", error.what()), "", "", {}}}, {}};
  }
}

}  // namespace

bool IsBatchFolder(const fs::path& folder) {
  return IsOutputFolder(folder) && Folder(folder).KindOf(kBatchFile) == Folder::Kind::kFile;
}

Differences DiffBatches(const DiffArguments& arguments) {
  const std::set<std::string> before = PlannedJobs(arguments.before), after = PlannedJobs(arguments.after);
  std::set<std::string> names = before;
  names.insert(after.begin(), after.end());
  Differences all;
  for (const std::string& name : names) {
    if (!after.contains(name) || !before.contains(name)) {
      all.changes.push_back(
          {"findings", after.contains(name) ? "its plan is new" : "its plan is gone", "", "", {}, name});
      continue;
    }
    Differences own = DiffJob(arguments, name);
    all.figures.merge(own.figures);
    for (Change& change : own.changes) {
      change.operation = change.operation.empty() ? name : name + "/" + change.operation;
      all.changes.push_back(std::move(change));
    }
  }
  return all;
}

}  // namespace millpose
