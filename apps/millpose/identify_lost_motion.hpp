// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose identify` makes of readings taken both ways.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "job/config/cell_settings.hpp"
#include "job/config/measurements.hpp"
#include "machine/identification/lost_motion_fit.hpp"

namespace millpose {

using LostMotionEstimates = std::array<LostMotionEstimate, 6>;

/// Throws InputError where the arm's gears are coupled: moving one axis then turns several.
LostMotionEstimates EstimateLostMotion(const MeasurementsSettings& settings, const ArmSettings& cell,
                                       const Arm& arm);
/// Whether every joint that was read has a number.
bool AllDetermined(const MeasurementsSettings& settings, const LostMotionEstimates& found);
void PrintLostMotion(const LostMotionEstimates& found);
nlohmann::ordered_json LostMotionJson(const LostMotionEstimates& found);

/// Puts it into the cell file; joints without a number keep theirs. Throws InputError where they have none.
void WriteLostMotion(const std::string& cell_file, const std::string& measurements, const ArmSettings& cell,
                     const LostMotionEstimates& found);

}  // namespace millpose
