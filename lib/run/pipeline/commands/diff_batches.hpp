// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/commands/diff_folders.hpp"

namespace millpose {

/// Whether a folder is the output folder of `millpose batch`.
bool IsBatchFolder(const std::filesystem::path& folder);

/// Compares the plans of two batches job by job, by their names; Change::operation is the job's name, of a
/// job of several operations with theirs behind a slash. A job that one of them alone has a plan of, or whose
/// two plans cannot be compared, is a change of findings. Throws InputError for what is no batch's folder.
Differences DiffBatches(const DiffArguments& arguments);

}  // namespace millpose
