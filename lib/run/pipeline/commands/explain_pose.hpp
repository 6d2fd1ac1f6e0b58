// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planning/external/stations.hpp"
#include "planning/result/plan_result.hpp"
#include "report/inspect.hpp"
#include "report/pose_reason.hpp"

namespace millpose {

/// What inspect tells of a point: the objective on all admissible branches every 3°, and why it has its pose.
/// Computed anew with the plan and the settings that the folder keeps (plan.cbor.gz, job.yaml, cell.yaml).
/// `number` of the point in the job. Throws InputError when they cannot be read.
PointStory TellPoint(const std::filesystem::path& folder, size_t number);

/// Why the point of a pass has its pose. Interference is what the plan learned of it.
PoseReason ExplainPose(const PlanResult& plan, const Stations& stations, size_t pass, size_t point);

}  // namespace millpose
