// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace millpose {

/// How long a plan cuts, s, at the feeds of its points: approaches, retracts and ways between left out.
struct AirTime {
  double cuts = 0;      ///< in all
  double nothing = 0;   ///< of them, motions that take nothing off
  double clear = 0;     ///< of these, those that no material is near
  double air_feed = 0;  ///< of these, those at a feed that was raised for it
};

/// What a plan takes off its raw part (docs/stock.md).
struct StockFigures {
  double blank = 0, removed = 0;  ///< mm³: as it comes to these cuts; what they take off it
  double spacing = 0;             ///< mm, of the lines on which it is known where material stands
  int left_out = 0;               ///< pieces left out, where spindle, holder or shank would have met material
  AirTime air;
};

/// "18 % of the cutting time (0:03:20) meets no material", with what of it is at the air feed.
std::string AirText(const AirTime& air);

}  // namespace millpose
