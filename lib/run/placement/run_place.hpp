// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose place`: where the part should stand (docs/placement.md).
#pragma once

#include "report/words/words.hpp"
#include "run/pipeline/operations/run_job.hpp"

namespace millpose {

/// What `millpose place` was asked for.
struct PlaceArguments {
  std::filesystem::path job;
  std::optional<std::filesystem::path> out;  ///< default: `<job name>.places` beside the job
  int threads = 0;                           ///< 0: all cores
  std::vector<Override> overrides;           ///< of settings of the job
  double max_points = 2e6;                   ///< that the tool path may have
  FileRoot root;                             ///< that all files must lie in
  Language language = Language::kEnglish;    ///< of the pages
};

/// Looks for a place by a sample of the job's points, plans the best ones and the job's own whole, and writes
/// what came of it into the output folder and the best, where it is better than the job's own, as a job
/// beside the job: JOB.placed.yaml. Throws InputError for bad input, Interrupted.
PlanOutcome RunPlace(const PlaceArguments& arguments, Progress& progress, const std::stop_token& stop);

}  // namespace millpose
