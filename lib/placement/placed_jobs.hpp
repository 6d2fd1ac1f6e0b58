// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs that are written beside a job: in its best place, or of every station.
#pragma once

#include "placement/place_results.hpp"

namespace millpose {

struct PlacedJob {
  std::filesystem::path file;
  std::string text;
};

/// Throws InputError where a file of somebody else's stands in the way of what may be written.
void RefuseForeignFiles(const std::filesystem::path& job, const PlacementSettings& placement);

/// The job that is recommended (JOB.placed.yaml), or one of every station (JOB.station_1.yaml and so on);
/// none where the job's own place is the best.
std::vector<PlacedJob> PlacedJobs(const FoundPlaces& found, const JobInputs& inputs,
                                  const PlaceArguments& arguments);

/// Writes them; of `stations` those go away that an earlier split had more of.
void WritePlacedJobs(const std::filesystem::path& job, const std::vector<PlacedJob>& jobs, bool stations);

}  // namespace millpose
