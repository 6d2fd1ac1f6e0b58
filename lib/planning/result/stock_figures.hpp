// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// What a plan takes off its raw part (docs/stock.md).
struct StockFigures {
  double blank = 0, removed = 0;  ///< mm³: as it comes to these cuts; what they take off it
  double spacing = 0;             ///< mm, of the lines on which it is known where material stands
  int left_out = 0;               ///< pieces left out, where spindle, holder or shank would have met material
};

}  // namespace millpose
