// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/commands/check.hpp"

namespace millpose {

/// CheckJob() for each operation of a job, or for the job itself where it has none. Of several each has a
/// page of its own, see ViewOf(). Throws InputError with what cannot be read of any; Interrupted.
std::vector<JobCheck> CheckOperations(const std::filesystem::path& job, const CheckJobArguments& arguments,
                                      const FileRoot& root, Progress& progress, const std::stop_token& stop);

/// Writes a job that names a CAM file for several tools or speeds as one with an operation for each
/// (SplitIntoOperations) to `to`, which must lie beside it. Returns their names. Throws InputError, also
/// where `to` is there already.
std::vector<std::string> WriteSplitJob(const std::filesystem::path& job, const std::filesystem::path& to,
                                       const FileRoot& root);

/// "check_01_face_pads.html": the page of operation `number`, from 0, where `view` is "check.html".
std::filesystem::path ViewOf(const std::filesystem::path& view, size_t number, const std::string& name);

}  // namespace millpose
