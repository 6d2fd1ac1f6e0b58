// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/compensation.hpp"

namespace millpose {

/// The `compensation` of summary.json, lengths in µm.
nlohmann::ordered_json CompensationJson(const CompensationFigures& figures);

}  // namespace millpose
