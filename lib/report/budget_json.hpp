// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/budget.hpp"

namespace millpose {

/// `budget` of summary.json; null where there is none.
nlohmann::ordered_json BudgetJson(const std::optional<Budget>& budget);
/// That of a summary.json as read back, names in words; empty where it has none. Throws
/// nlohmann::json::exception for what is no summary.
std::optional<Budget> ReadBudget(const nlohmann::json& summary);

}  // namespace millpose
