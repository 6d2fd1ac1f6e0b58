// SPDX-License-Identifier: GPL-3.0-or-later
// What run.json says of a run of `plan`, and where its folder is.
#pragma once

#include "report/report.hpp"
#include "run/pipeline/outputs/run.hpp"
#include "run/pipeline/stages/stages.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// Whether the pages of a run open in this language; `asked` as its run.json has it.
bool WasSaidIn(std::string_view asked, Language language);

/// The folder that a job file stands in.
std::filesystem::path FolderOf(const std::filesystem::path& job);

/// All settings given in place of the job file's.
std::vector<Override> OverridesOf(const PlanArguments& arguments);

/// Beside the job; the resolved job of an output folder is planned there again.
std::filesystem::path DefaultFolder(const std::filesystem::path& job, const std::string& name);

/// What run.json says before the run begins. `job_folder`: what the paths inside the job are relative to.
/// Throws InputError where the folder holds the plan of another job of the same name.
RunFigures BeginRun(const PlanArguments& arguments, const std::string& name,
                    const std::filesystem::path& job_folder, const OutputFolder& folder);

/// And when it has ended, but for what it took from checkpoints.
RunFigures EndRun(const RunFigures& begun, const Stages& stages, int threads);

}  // namespace millpose
