// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/up_to_date.hpp"

#include <nlohmann/json.hpp>

#include "base/folder.hpp"
#include "base/process.hpp"
#include "store/manifest.hpp"
#include "store/output_folder.hpp"
#include "store/result_swap.hpp"

namespace millpose {

namespace {

nlohmann::json RunOf(const std::filesystem::path& folder) {
  return nlohmann::json::parse(Folder(folder).Read(kRunFile));
}

}  // namespace

bool HoldsPlanOf(const std::filesystem::path& folder, const std::string& key) {
  try {
    return IsOutputFolder(folder) && !IsSwapOpen(Folder(folder)) &&
           RunOf(folder).at("program_id") == ProgramId() && CheckManifest(folder).key == key;
  } catch (const std::exception&) {  // whatever is wrong with the folder: it is planned anew
    return false;
  }
}

std::optional<ExistingPlan> FindExistingPlan(const std::filesystem::path& folder, const std::string& key,
                                             const RunFigures& run) {
  if (!HoldsPlanOf(folder, key)) return std::nullopt;
  try {
    const nlohmann::json last = RunOf(folder);
    if (last.at("asked") != run.asked || last.at("job").at("file") != run.job.file ||
        last.at("job_folder").at("absolute") != run.job_folder.absolute)
      return std::nullopt;
    return ExistingPlan{last.at("exit_status").get<int>(), last.at("told").get<std::string>(),
                        last.at("details").get<std::string>()};
  } catch (const nlohmann::json::exception&) {  // run.json says less
    return std::nullopt;
  }
}

}  // namespace millpose
