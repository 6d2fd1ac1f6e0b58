// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/budget_json.hpp"

#include <algorithm>

namespace millpose {

nlohmann::ordered_json BudgetJson(const std::optional<Budget>& budget) {
  using Json = nlohmann::ordered_json;
  if (!budget) return nullptr;
  Json rows = Json::array();
  for (const BudgetRow& row : budget->rows)
    rows.push_back({{"source", row.key},
                    {"um", row.largest ? Json(1e3 * *row.largest) : Json(nullptr)},
                    {"basis", row.basis}});
  return {{"along", "normal"},
          {"rows", rows},
          {"sum_um", 1e3 * budget->Sum()},
          {"sum_leaves_out", budget->LeftOut()}};
}

std::optional<Budget> ReadBudget(const nlohmann::json& summary) {
  const nlohmann::json& known = summary.at("budget");
  if (!known.is_object()) return std::nullopt;
  Budget budget;
  for (const nlohmann::json& row : known.at("rows")) {
    std::string key = row.at("source").get<std::string>();
    std::string name = key;
    std::ranges::replace(name, '_', ' ');
    budget.rows.push_back(
        {std::move(key), std::move(name),
         row.at("um").is_number() ? std::optional(row.at("um").get<double>() / 1e3) : std::nullopt,
         row.at("basis").get<std::string>()});
  }
  return budget;
}

}  // namespace millpose
