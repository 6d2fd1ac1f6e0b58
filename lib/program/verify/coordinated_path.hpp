// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "machine/collision/world.hpp"

namespace millpose {

/// A motion on which the external axes go evenly from one position to another.
struct CoordinatedPath {
  ExternalPosition from, to;
  /// At shares of the way, from 0 to 1; between two of them the joints turn evenly.
  std::vector<std::pair<double, Joints>> joints;
};

/// With how much of the clearances a way is to be free, as Checker takes them.
struct CoordinatedClearance {
  double share = 1, reserve = 0;
  double resolution = 0.5;  ///< mm by which a clearance may be missed beyond that
};

/// The first pair of bodies found too near while arm and external axes move on `way`, in Phase::kCutting;
/// also such as stand still where only the arm moves. Empty: no checked pair comes nearer than its clearance
/// less reserve and resolution. `at_zero`: the world with the external axes at 0.
std::optional<Interference> FindOnCoordinatedMotion(const World& at_zero, const CoordinatedPath& way,
                                                    const CoordinatedClearance& clearance);

}  // namespace millpose
