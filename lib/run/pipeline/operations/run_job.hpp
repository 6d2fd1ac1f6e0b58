// SPDX-License-Identifier: GPL-3.0-or-later
// A job from its file to its output folder, also one of several operations (docs/operations.md).
#pragma once

#include "job/inputs.hpp"
#include "run/pipeline/outputs/run.hpp"

namespace millpose {

/// RunPlan() for a job that is one operation. One of several has an output folder for each,
/// OUT/operations/N_NAME, and in OUT what is of all: a main program for each controller that calls theirs,
/// points, summary, report. Throws as RunPlan() does; what is wrong with any operation is reported before the
/// first is planned.
PlanOutcome RunJob(const PlanArguments& arguments, Progress& progress, std::stop_token stop);

/// The operations of a job, each with everything it names; the job itself where it has none. Throws
/// InputError with what is wrong with any.
std::vector<JobInputs> LoadOperations(const std::filesystem::path& job,
                                      const std::vector<Override>& overrides, const FileRoot& root);

/// The hash of all that the plan in `folder` of a job depends on, as its manifest's key has it: `inputs` as
/// LoadOperations() returns them.
std::string KeyOf(std::vector<JobInputs> inputs, const std::filesystem::path& folder);

/// "02_drill": the folder of operation `number`, from 0.
std::string OperationFolder(size_t number, const std::string& name);

}  // namespace millpose
