// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/budget.hpp"

namespace millpose {

/// `budget` of summary.json; null where there is none.
nlohmann::ordered_json BudgetJson(const std::optional<Budget>& budget);

}  // namespace millpose
