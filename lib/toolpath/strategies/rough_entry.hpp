// SPDX-License-Identifier: GPL-3.0-or-later
// Down into a layer that is open to no side.
#pragma once

#include "toolpath/strategies/rough_layer.hpp"

namespace millpose {

/// A helix about a place, with a full turn on the floor; where there is no room for one of 0.3 of the disc's
/// radius, a ramp to and fro on the longest line through the place, which is at least a diameter long for a
/// cutter that does not cut over its centre, a quarter for others. Empty where there is no room for that
/// either.
std::vector<Eigen::Vector3d> RoughEntry(const RoughRoom& room, const RoughLayerOptions& options,
                                        const Eigen::Vector2d& place, double most_room, double disc,
                                        double top);

}  // namespace millpose
