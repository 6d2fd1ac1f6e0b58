// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "planning/result/stock_figures.hpp"

namespace millpose {

/// `stock` of summary.json.
nlohmann::ordered_json StockJson(const StockFigures& stock);

/// What StockJson() has written of the time in the air.
AirTime AirTimeOf(const nlohmann::ordered_json& stock);

}  // namespace millpose
