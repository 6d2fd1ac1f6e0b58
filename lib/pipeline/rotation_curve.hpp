// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "report/inspect.hpp"

namespace millpose {

/// The objective over the rotation about the tool axis at the point of one row, every 3°, all admissible
/// branches, computed anew with the settings that the output folder keeps (job.yaml, cell.yaml). Throws
/// InputError when they cannot be read.
std::vector<RotationSample> RotationCurve(const std::filesystem::path& folder, const PointsTable& points,
                                          size_t row);

}  // namespace millpose
