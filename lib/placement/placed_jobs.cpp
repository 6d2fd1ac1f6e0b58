// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/placed_jobs.hpp"

#include "base/error.hpp"
#include "base/file.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPlacedHead = "# Written by millpose place; it may write over this file again.\n";

/// JOB.`word`.yaml, beside the job.
fs::path Beside(const fs::path& job, const std::string& word) {
  return job.parent_path() / (job.stem().string() + "." + word + job.extension().string());
}

/// JOB.station_1.yaml and so on.
fs::path StationFile(const fs::path& job, size_t number) {
  return Beside(job, fmt::format("station_{}", number));
}

bool IsOurs(const fs::path& placed) { return ReadFile(placed).starts_with(kPlacedHead); }

void RefuseForeign(const fs::path& placed) {
  if (Exists(placed) && !IsOurs(placed))
    throw InputError(
        Place{placed.string()},
        "stands where the placed job would be written, and millpose place did not write it; move "
        "it away");
}

/// Of an earlier split between more stations.
void RemoveLaterStations(const fs::path& job, size_t count) {
  for (size_t i = count + 1; i <= size_t{kMostStations}; ++i)
    if (Exists(StationFile(job, i)) && IsOurs(StationFile(job, i))) RemoveAll(StationFile(job, i));
}

}  // namespace

void RefuseForeignFiles(const fs::path& job, const PlacementSettings& placement) {
  RefuseForeign(Beside(job, "placed"));
  if (!placement.stations) return;
  for (size_t i = 1; i <= static_cast<size_t>(placement.stations->most); ++i)
    RefuseForeign(StationFile(job, i));
}

std::vector<PlacedJob> PlacedJobs(const FoundPlaces& found, const JobInputs& inputs,
                                  const PlaceArguments& arguments) {
  std::vector<PlacedJob> jobs;
  const auto add = [&](const fs::path& file, const std::string& head, const std::vector<Override>& own) {
    std::vector<Override> overrides = arguments.overrides;
    std::ranges::copy(own, std::back_inserter(overrides));
    jobs.push_back(
        {file, kPlacedHead + head + WithOverrides(inputs.job_text, arguments.job.string(), overrides)});
  };
  if (found.split) {
    const std::vector<PlannedStation>& stations = found.splits[*found.split].stations;
    for (size_t i = 0; i < stations.size(); ++i)
      add(StationFile(arguments.job, i + 1),
          fmt::format("# Station {} of {}: mills what lies {} along toolpath.share.direction. Measure there "
                      "where it stands, and plan again.\n",
                      i + 1, stations.size(), SpanText(stations[i].share)),
          StationOverrides(found.job, i + 1, stations[i].share, stations[i].plan.place, found.robot));
  } else if (found.recommended > 0) {
    std::vector<Override> own = OverridesOf(found.plans[found.recommended].place, found.robot);
    own.push_back({"name", found.job + "_placed"});
    add(Beside(arguments.job, "placed"), "", own);
  }
  return jobs;
}

void WritePlacedJobs(const fs::path& job, const std::vector<PlacedJob>& jobs, bool stations) {
  for (const PlacedJob& placed : jobs) WriteFileAtomically(placed.file, placed.text);
  if (stations) RemoveLaterStations(job, jobs.size());
}

}  // namespace millpose
