// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of a batch on this machine.
#pragma once

#include "run/batch/batch.hpp"

namespace millpose {

/// Plans `jobs` (those that are not up to date) into `folder`/<name>, each in a child process, as many at a
/// time as `threads` and the memory allow. A job takes its share of the threads that no other holds: one that
/// starts alone takes all. Throws Interrupted.
std::vector<JobOutcome> RunHere(const std::vector<BatchJob>& jobs, const std::filesystem::path& folder,
                                const BatchArguments& arguments, int threads, Progress& progress,
                                std::stop_token stop);

}  // namespace millpose
