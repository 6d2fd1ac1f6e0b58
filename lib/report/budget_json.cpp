// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/budget_json.hpp"

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

}  // namespace millpose
