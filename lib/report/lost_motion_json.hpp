// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/lost_motion.hpp"

namespace millpose {

/// `reversals` of summary.json.
nlohmann::ordered_json ReversalsJson(const PlanResult& plan, const LostMotionReport& report);
/// Counts and marks of a tally; `known`: whether lost motion is, else marks are per arcmin.
nlohmann::ordered_json TallyJson(const std::vector<ExternalAxis>& external, const GearTally& tally,
                                 bool known);

}  // namespace millpose
