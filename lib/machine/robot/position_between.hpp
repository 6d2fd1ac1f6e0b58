// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/mechanism.hpp"

namespace millpose {

/// Where the external axes are when they have gone `share` (0..1) of their way, evenly and all together.
inline ExternalPosition PositionBetween(const ExternalPosition& from, const ExternalPosition& to,
                                        double share) {
  if (share >= 1) return to;
  ExternalPosition position = from;
  for (size_t i = 0; i < position.size(); ++i) position[i] += share * (to[i] - from[i]);
  return position;
}

}  // namespace millpose
