// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/stock_json.hpp"

namespace millpose {

nlohmann::ordered_json StockJson(const StockFigures& stock) {
  return {{"blank_cm3", stock.blank / 1e3},
          {"removed_cm3", stock.removed / 1e3},
          {"spacing_mm", stock.spacing},
          {"pieces_left_out", stock.left_out},
          {"air",
           {{"cuts_s", stock.air.cuts},
            {"nothing_cut_s", stock.air.nothing},
            {"clear_s", stock.air.clear},
            {"air_feed_s", stock.air.air_feed}}}};
}

AirTime AirTimeOf(const nlohmann::ordered_json& stock) {
  const nlohmann::ordered_json& air = stock.at("air");
  return {air.at("cuts_s"), air.at("nothing_cut_s"), air.at("clear_s"), air.at("air_feed_s")};
}

}  // namespace millpose
