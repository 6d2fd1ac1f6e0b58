// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/report.hpp"

namespace millpose {

/// `fixed_rotation` of summary.json; null where there is no comparison.
nlohmann::ordered_json FixedRotationJson(const PlanResult& plan, const ReportInputs& inputs);

}  // namespace millpose
