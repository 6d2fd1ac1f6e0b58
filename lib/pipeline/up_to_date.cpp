// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/up_to_date.hpp"

#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/process.hpp"
#include "pipeline/manifest.hpp"

namespace millpose {

std::optional<StandingPlan> FindStandingPlan(const std::filesystem::path& folder, const std::string& key,
                                             const RunFigures& run) {
  try {
    if (!Exists(folder / kManifestFile) || !Exists(folder / kRunFile)) return std::nullopt;
    const nlohmann::json last = nlohmann::json::parse(ReadFile(folder / kRunFile));
    if (last.at("program_id") != ProgramId() || last.at("asked") != run.asked ||
        last.at("job").at("file") != run.job.file ||
        last.at("job_folder").at("absolute") != run.job_folder.absolute)
      return std::nullopt;
    if (CheckManifest(folder).key != key) return std::nullopt;
    return StandingPlan{last.at("exit_status").get<int>(), last.at("told").get<std::string>()};
  } catch (const std::exception&) {  // whatever is wrong with the folder: it is planned anew
    return std::nullopt;
  }
}

}  // namespace millpose
