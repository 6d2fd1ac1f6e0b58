// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "planning/result/stock_figures.hpp"

namespace millpose {

/// `stock` of summary.json.
nlohmann::ordered_json StockJson(const StockFigures& stock);

}  // namespace millpose
