// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/stock_figures.hpp"

#include <fmt/format.h>

#include "planning/result/cycle_time.hpp"

namespace millpose {

std::string AirText(const AirTime& air) {
  const double share = air.cuts > 0 ? air.nothing / air.cuts : 0;
  std::string text =
      fmt::format("{:.0f} % of the cutting time ({}) meets no material", 100 * share, ClockText(air.nothing));
  if (air.air_feed > 0) text += fmt::format(", {} of it at the air feed", ClockText(air.air_feed));
  return text;
}

}  // namespace millpose
