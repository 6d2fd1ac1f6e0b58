// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of a batch as array jobs of Slurm on a folder that all machines share. Slurm does the scheduling.
#pragma once

#include <variant>

#include "run/batch/batch.hpp"

namespace millpose {

/// Plans `jobs` (those that are not up to date) into `folder`/<name> by array jobs: first the passes of every
/// job that has more than one share, spread over as many tasks, as checkpoints, then one task per job that
/// gathers them and finishes. A task that fails is submitted once more. What an earlier call submitted
/// and is still in Slurm's queue is waited for first. Returns how the jobs ended; with `options.detach`
/// everything is submitted and a sentence for the user returned. Throws InputError when sbatch cannot be
/// used, Interrupted when `stop` was requested; what was submitted then goes on until `scancel`.
std::variant<std::vector<JobOutcome>, std::string> RunOnSlurm(const std::vector<BatchJob>& jobs,
                                                              const std::filesystem::path& folder,
                                                              int threads, bool fresh,
                                                              const SlurmOptions& options, Progress& progress,
                                                              std::stop_token stop);

}  // namespace millpose
