// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "job/inputs.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A plan's folder, of one set.
struct PlanFolder {
  PlanResult plan;
  JobInputs inputs;     ///< as the plan has them; triangles of STEP files as the plan kept them
  std::string summary;  ///< summary.json
};

/// Reads plan, summary, job and everything that this names, as one plan wrote them (ReadWhole). `job`: the
/// plan's job file, where that does not stand beside the folder. Throws InputError: for what cannot be read,
/// for the folder of several operations, and with kAsWritten for what is other than the folder's manifest
/// says.
enum class PlanFiles : uint8_t { kAsWritten, kAsTheyStand };
PlanFolder ReadPlanFolder(const std::filesystem::path& folder,
                          const std::optional<std::filesystem::path>& job, const FileRoot& root,
                          PlanFiles files = PlanFiles::kAsWritten);

}  // namespace millpose
