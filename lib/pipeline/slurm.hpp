// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of a batch as array jobs of Slurm on a folder that all machines share. Slurm does the scheduling.
#pragma once

#include "pipeline/batch.hpp"

namespace millpose {

/// Plans `jobs` (those that are not up to date) into `folder`/<name> by `sbatch --wait --array`: first, with
/// more than one share, the passes of every job spread over `options.shares` tasks as checkpoints, then one
/// task per job that gathers them and finishes. A task that fails is submitted once more. With
/// `options.detach` everything is submitted and empty is returned; the same command later gathers. Throws
/// InputError when sbatch cannot be used, Interrupted when `stop` was requested; what was submitted then goes
/// on until `scancel`.
std::optional<std::vector<JobOutcome>> RunOnSlurm(const std::vector<BatchJob>& jobs,
                                                  const std::filesystem::path& folder, int threads,
                                                  bool fresh, const SlurmOptions& options, Progress& progress,
                                                  std::stop_token stop);

}  // namespace millpose
