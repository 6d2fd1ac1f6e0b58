// SPDX-License-Identifier: GPL-3.0-or-later
// One cut through the material of a layer, step by step, so that the engagement stays below its bound.
#pragma once

#include <optional>

#include "toolpath/strategies/rough_room.hpp"

namespace millpose {

struct RoughMarchOptions {
  double engagement = 0;  ///< which no step exceeds, rad
  bool climb = true;      ///< material on the right of the way
};

/// A way of the tip across the axis, and the cells that it took off.
struct RoughCut {
  std::vector<Eigen::Vector2d> way;
  std::vector<int> taken;
};

/// The direction in which a cut may begin at a place that is free of material: with most of it on the proper
/// side and not more than the engagement allows. None where there is none.
std::optional<Eigen::Vector2d> RoughStart(const RoughMaterial& material, const RoughRoom& room,
                                          const RoughMarchOptions& options, const Eigen::Vector2d& place);

/// From a place on: each step turns towards the material as far as engagement and part allow, so that the way
/// follows what was cut before at the distance of the engagement, and the part's walls. It ends where nothing
/// was cut for a radius, or where no step is allowed; what is behind the last chip is dropped. What it takes
/// off is gone from `material`.
RoughCut RoughMarch(RoughMaterial& material, const RoughRoom& room, const RoughMarchOptions& options,
                    const Eigen::Vector2d& place, const Eigen::Vector2d& direction);

}  // namespace millpose
