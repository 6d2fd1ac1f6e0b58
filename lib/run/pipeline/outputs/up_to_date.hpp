// SPDX-License-Identifier: GPL-3.0-or-later
// A plan that stands already: the same inputs, program and wishes, and every file as it was written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "report/report.hpp"

namespace millpose {

/// How a run in an output folder ended: what it told and its exit status.
struct ExistingPlan {
  int exit_status = 0;
  std::string told, details;  ///< as RunFigures has them

  const std::string& Told(bool verbose) const { return verbose && !details.empty() ? details : told; }
};

/// What `plan` adds to what was told where nothing was planned again.
inline constexpr const char* kUnchanged = "unchanged  this plan is up to date; nothing was planned again\n";

/// Whether the plan in `folder` was made by this very program, of inputs whose hash is `key`, and every file
/// is as it was written.
bool HoldsPlanOf(const std::filesystem::path& folder, const std::string& key);

/// What the last run in `folder` told, where that holds (HoldsPlanOf) and it was asked for the same
/// (RunFigures::asked, job and job_folder of `run`). Empty where anything differs or cannot be read.
std::optional<ExistingPlan> FindExistingPlan(const std::filesystem::path& folder, const std::string& key,
                                             const RunFigures& run);

}  // namespace millpose
