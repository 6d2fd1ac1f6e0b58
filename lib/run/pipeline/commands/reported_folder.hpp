// SPDX-License-Identifier: GPL-3.0-or-later
// What the pages of `millpose report` are made of: a plan's output folder, or that of all operations of a
// job.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "job/inputs.hpp"
#include "planning/result/plan_result.hpp"
#include "report/words/words.hpp"

namespace millpose {

struct SetupArguments {
  std::filesystem::path plan;                ///< output folder of `millpose plan`
  std::optional<std::filesystem::path> job;  ///< of it, where it does not stand beside the folder
  FileRoot root{};
  Language language = Language::kEnglish;  ///< of the page
};

/// One operation, or the job where it has none.
struct FolderOperation {
  std::string name,
      folder;  ///< the folder below the job's output folder; empty where that holds the one plan
  PlanResult plan;
  JobInputs inputs;
  std::string summary;  ///< summary.json
};

struct ReportedFolder {
  std::string job;
  std::vector<FolderOperation> operations;  ///< at least one, in the order of the work
  bool several = false;                     ///< the job lists operations
  std::string main;                         ///< the summary.json of all of them, empty where the job is one
};

/// A program file as the summaries have it; `path` below the folder.
struct FolderProgram {
  std::string operation, controller, path;
  std::string read_back;  ///< words of what the read-back found
  bool written = false;
};

/// Throws InputError for a folder that is none of `millpose plan` and for what cannot be read.
ReportedFolder ReadReportedFolder(const SetupArguments& arguments);

/// Main programs first, then those of the operations in their order.
std::vector<FolderProgram> ProgramsIn(const ReportedFolder& folder);

/// "Cell …, arm …. Inputs …."
std::string SubtitleOf(const ReportedFolder& folder);

}  // namespace millpose
