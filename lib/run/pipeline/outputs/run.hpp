// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "base/file_root.hpp"
#include "base/progress.hpp"
#include "job/config/config.hpp"
#include "report/words/words.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// What `millpose plan` was asked for.
struct PlanArguments {
  std::filesystem::path job;
  std::optional<std::filesystem::path> out;  ///< default: `<job name>.out` beside the job
  int threads = 0;                           ///< 0: all cores
  std::optional<uint64_t> seed;              ///< instead of the job's
  std::vector<Override> overrides;           ///< of other settings of the job
  bool audit = false;                        ///< recompute the figures of summary.json's `audit`
  bool face = false;                         ///< also the face that the plan will leave
  bool full_axis_map = false;                ///< check for interference all that report.html maps
  double max_points = 2e6;                   ///< that the tool path may have
  bool verbose = false;                      ///< the outcome's text has all figures
  bool fresh = false;                        ///< ignore checkpoints
  Language language = Language::kEnglish;    ///< in which report.html opens
  std::optional<double> trajectory;          ///< s between the rows of trajectory-<controller>.csv
  FileRoot root;                             ///< that all files must lie in; with it also a folder by default
  std::optional<size_t> operation;           ///< which one, of a job with several
  std::vector<CutsOfTool> cut_before;        ///< JobInputs::cut_before
  std::string before;                        ///< hash of what these depend on; empty: nothing
  std::optional<Share> share;                ///< plan only these passes, leave them as checkpoints, and end
};

struct PlanOutcome {
  int exit_status = 0;  ///< 0 done, 1 done with findings
  std::string text;     ///< the screenful for the user
};

/// What a run in an output folder has to say of it, as lines for the user.
std::string WarningLines(const OutputFolder& folder);

/// One operation of a job with several (PlanArguments::operation): its results are added to those of `whole`,
/// the ones that stand in `folder` (OutputFolder::Operation) where they are up to date. `whole` is null where
/// only a share is planned. Throws as RunPlan().
PlanOutcome PlanOperation(const PlanArguments& arguments, const OutputFolder& folder, ResultSet* whole,
                          Progress& progress, std::stop_token stop);

/// The whole way from a job file to a folder of programs and reports. Throws InputError for bad input,
/// Interrupted when `stop` was requested (what was planned stays as checkpoints).
PlanOutcome RunPlan(const PlanArguments& arguments, Progress& progress, std::stop_token stop);

}  // namespace millpose
