// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/placed_jobs.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/loose_file.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kHeadStart = "# Written by millpose place (";
constexpr std::string_view kHeadEnd = "), which writes over this file again unless it was edited.\n";

/// A job's text below the line that says by whom it was written, with the hash of all that follows.
std::string Signed(const std::string& text) {
  return fmt::format("{}{}{}{}", kHeadStart, Hash(text), kHeadEnd, text);
}

/// Whether millpose place wrote the file and nobody edited it since. What is no regular file is not opened.
bool IsAsWritten(const fs::path& file) {
  std::error_code error;
  if (fs::symlink_status(file, error).type() != fs::file_type::regular) return false;
  const std::string bytes = ReadFile(file);
  const size_t line = bytes.find('\n');
  return bytes.starts_with(kHeadStart) && line != std::string::npos &&
         bytes == Signed(bytes.substr(line + 1));
}

bool IsFree(const fs::path& file) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(file, error).type();
  return type == fs::file_type::not_found || IsAsWritten(file);
}

/// JOB.`word`.yaml beside the job, or, where that was edited or is somebody else's, JOB.`word`.1.yaml and so
/// on.
fs::path FileBeside(const fs::path& job, const std::string& word) {
  const auto named = [&](const std::string& end) {
    return job.parent_path() /
           fmt::format("{}.{}{}{}", job.stem().string(), word, end, job.extension().string());
  };
  fs::path file = named("");
  for (int number = 1; !IsFree(file); ++number) file = named(fmt::format(".{}", number));
  return file;
}

/// Whether a file of this name may be one that was written beside the job.
bool IsOfPlace(const std::string& name, const fs::path& job) {
  const std::string stem = job.stem().string();
  return (name.starts_with(stem + ".placed.") || name.starts_with(stem + ".station_")) &&
         fs::path(name).extension() == job.extension();
}

}  // namespace

std::vector<PlacedJob> PlacedJobs(const FoundPlaces& found, const JobInputs& inputs,
                                  const PlaceArguments& arguments) {
  std::vector<PlacedJob> jobs;
  const auto add = [&](const std::string& word, const std::string& head, const std::vector<Override>& own) {
    std::vector<Override> overrides = arguments.overrides;
    std::ranges::copy(own, std::back_inserter(overrides));
    jobs.push_back({FileBeside(arguments.job, word),
                    Signed(head + WithOverrides(inputs.job_text, arguments.job.string(), overrides))});
  };
  if (found.split) {
    const std::vector<PlannedStation>& stations = found.splits[*found.split].stations;
    for (size_t i = 0; i < stations.size(); ++i)
      add(fmt::format("station_{}", i + 1),
          fmt::format("# Station {} of {}: mills what lies {} along toolpath.share.direction. Measure there "
                      "where it stands, and plan again.\n",
                      i + 1, stations.size(), SpanText(stations[i].share)),
          StationOverrides(found.job, i + 1, stations[i].share, stations[i].plan.place, found.robot));
  } else if (found.recommended > 0) {
    std::vector<Override> own = OverridesOf(found.plans[found.recommended].place, found.robot);
    own.push_back({"name", found.job + "_placed"});
    add("placed", "", own);
  }
  return jobs;
}

void WritePlacedJobs(const fs::path& job, const std::vector<PlacedJob>& jobs) {
  for (const PlacedJob& placed : jobs) WriteLooseFile(placed.file, placed.text);
  const fs::path folder = job.has_parent_path() ? job.parent_path() : fs::path(".");
  for (const fs::path& entry : EntriesOf(folder)) {
    const fs::path file = job.parent_path() / entry.filename();  // as `jobs` names it
    const bool is_new =
        std::ranges::any_of(jobs, [&](const PlacedJob& placed) { return placed.file == file; });
    if (!is_new && IsOfPlace(file.filename().string(), job) && IsAsWritten(file)) RemoveAll(file);
  }
}

}  // namespace millpose
