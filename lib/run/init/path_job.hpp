// SPDX-License-Identifier: GPL-3.0-or-later
// A first job of a CAM file: where its path could stand before the arm, and how the arm fares there.
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "run/init/place_part.hpp"
#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// One operation of a CAM file's job, or the job itself, as it is laid.
struct PathOperation {
  JobInputs inputs;
  Toolpath toolpath;  ///< in P
};

/// Throws InputError for what cannot be read, and for a path that holds no cut.
std::vector<PathOperation> LayPathOperations(const std::filesystem::path& job, const std::stop_token& stop);

/// What all of them cut, as a group that looks the way the tools do in the mean. Frame P.
FacingGroup GroupOfPath(const std::vector<PathOperation>& operations);

/// At most `most` places at which each operation reaches some of its points, clear of the cell, with its own
/// tool. Throws Interrupted.
std::vector<Placement> PlacesOfPath(const std::vector<PathOperation>& operations, size_t most,
                                    const std::stop_token& stop);

/// TryJob of each operation where its job places it, their sum; the first problem ends it.
TriedJob TryOperations(const std::vector<PathOperation>& operations, size_t most_points,
                       const CheckpointStore& checkpoints, const Execution& execution);

}  // namespace millpose
