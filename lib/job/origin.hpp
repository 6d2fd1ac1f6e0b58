// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/file_root.hpp"
#include "report/report.hpp"

namespace millpose {

/// What the paths inside a job are relative to: the job's folder; for the resolved job.yaml of an output
/// folder the folder of the job that was planned, as run.json says. `named`: a file that the job names, by
/// which that folder is known; run.json is read within `root`. Throws InputError when it is not there.
std::filesystem::path OriginOf(const std::filesystem::path& job_file, const std::filesystem::path& named,
                               const FileRoot& root);

/// `job_folder` as run.json of the output folder `out` keeps it: absolute, and relative to `out`, so that job
/// and results may be moved together.
RunFigures::JobFolder KeepOrigin(const std::filesystem::path& job_folder, const std::filesystem::path& out);

/// What run.json of the output folder `out` is to say of the job `file` called `name`; where it is that
/// folder's own resolved job.yaml, what the folder says already. Throws InputError where the folder holds the
/// plan of another job of that name, which still stands where it stood: programs of one would pass for the
/// other's.
RunFigures::JobFile JobFileFor(const std::filesystem::path& file, const std::string& name,
                               const std::filesystem::path& out);

}  // namespace millpose
