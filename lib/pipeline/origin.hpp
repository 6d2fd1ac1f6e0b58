// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "report/report.hpp"

namespace millpose {

/// What the paths inside a job are relative to: the job's folder; for the resolved job.yaml of an output
/// folder the folder of the job that was planned, as run.json says. `named`: a file that the job names, by
/// which that folder is known. Throws InputError when it is not there.
std::filesystem::path OriginOf(const std::filesystem::path& job_file, const std::filesystem::path& named);

/// `job_folder` as run.json of the output folder `out` keeps it: absolute, and relative to `out`, so that job
/// and results may be moved together.
RunFigures::JobFolder KeepOrigin(const std::filesystem::path& job_folder, const std::filesystem::path& out);

}  // namespace millpose
