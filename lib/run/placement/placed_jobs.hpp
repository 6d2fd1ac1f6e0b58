// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs that are written beside a job: in its best place, or of every station.
#pragma once

#include "run/placement/place_results.hpp"

namespace millpose {

struct PlacedJob {
  std::filesystem::path file;
  std::string text;
};

/// The job that is recommended (JOB.placed.yaml), or one of every station (JOB.station_1.yaml and so on);
/// none where the job's own place is the best. What stands under such a name and is not as millpose place
/// wrote it stays: the next name is taken (JOB.placed.1.yaml).
std::vector<PlacedJob> PlacedJobs(const FoundPlaces& found, const JobInputs& inputs,
                                  const PlaceArguments& arguments);

/// Writes them; those that earlier runs wrote beside the job, and nobody edited, go away.
void WritePlacedJobs(const std::filesystem::path& job, const std::vector<PlacedJob>& jobs);

}  // namespace millpose
