// SPDX-License-Identifier: GPL-3.0-or-later
// millpose verify: programs of an output folder against its plan, or one program against a cell alone.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/file_root.hpp"
#include "base/progress.hpp"
#include "program/verify/corner_bound.hpp"
#include "program/verify/verify.hpp"
#include "run/pipeline/programs/program_files.hpp"

namespace millpose {

struct VerifyArguments {
  std::filesystem::path target;               ///< output folder of plan, or a program's main file
  std::optional<std::filesystem::path> cell;  ///< for a program
  std::string tool;                           ///< likewise: which of the cell's; empty: its only one
  std::optional<std::filesystem::path>
      job;  ///< for a folder: its job, where it does not stand beside the folder
  std::optional<std::filesystem::path> plan;  ///< for a program: the output folder that it was written in
  bool interference = false;                  ///< check every motion again, not only what leaves the plan's
  int threads = 0;                            ///< 0: all cores
  FileRoot root{};                            ///< that all files must lie in
};

/// One program as replayed.
struct VerifiedProgram {
  std::string controller, file;
  size_t motions = 0;
  std::vector<Finding> findings;  ///< empty: confirmed
  /// What the verdict rests on beyond program and cell, where there is no plan.
  std::vector<std::string> assumptions;
  /// Files of it that are not as they were written, by name; what counts in them is compared all the same.
  std::vector<std::string> changed = {};
  std::string scope = {};                   ///< what was compared, where that is not all of the plan
  std::optional<CornerBound> but_for = {};  ///< for which alone it is confirmed
};

/// Reads the programs and replays them; a folder as one who knows that it stands still (VerifyJob). Throws
/// InputError for what cannot be read (a program among it).
std::vector<VerifiedProgram> VerifyPrograms(const VerifyArguments& arguments, Progress& progress,
                                            std::stop_token stop);

/// The outcome for people: one line a program, one a finding.
std::string VerifyText(const std::vector<VerifiedProgram>& programs);
/// The same as JSON, schema_version 1.
std::string VerifyJson(const std::vector<VerifiedProgram>& programs);

}  // namespace millpose
