// SPDX-License-Identifier: GPL-3.0-or-later
// Ways within a layer where nothing stands.
#pragma once

#include <functional>
#include <span>

#include "toolpath/strategies/rough_room.hpp"

namespace millpose {

/// Looks through the cells that the disc can reach from a place without meeting material, the nearer ones
/// first, for one that `take` says yes to. The way there, straightened, with both ends; empty where there is
/// none.
std::vector<Eigen::Vector2d> RoughAirWay(const RoughMaterial& material, const RoughRoom& room,
                                         const Eigen::Vector2d& from, const std::function<bool(int)>& take);

/// The places of a way that keep straight lines between them within `tolerance` (mm) of it, and which take
/// the tip no farther than 0.02 mm into the part's allowance.
std::vector<Eigen::Vector2d> RoughThinned(std::span<const Eigen::Vector2d> way, const RoughRoom& room,
                                          double tolerance);

}  // namespace millpose
