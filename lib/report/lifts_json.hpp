// SPDX-License-Identifier: GPL-3.0-or-later
// What summary.json says of lifts, rings left open and steps in the surface.
#pragma once

#include <nlohmann/json.hpp>

#include "report/report.hpp"

namespace millpose {

/// Where the tool is lifted because that pays.
nlohmann::ordered_json LiftsJson(const PlanResult& plan);

/// The passes that are rings left open.
nlohmann::ordered_json OpenRingsJson(const PlanResult& plan);

nlohmann::ordered_json StepJson(const PoseStep& step);

/// Null where the cell does not say how well the tool is known.
nlohmann::ordered_json StepsJson(const std::optional<PoseSteps>& steps);

}  // namespace millpose
