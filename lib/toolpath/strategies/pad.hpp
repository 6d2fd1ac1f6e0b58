// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategy.hpp"

namespace millpose {

/// Facing of a plane pad: a zigzag whose lines are joined along the borders, or rings from the borders
/// inwards joined to a spiral. The tool keeps its offset from border and islands.
struct Pad final : SurfaceStrategy {
  bool spiral = false;
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< the zigzag's lines run so; unit vector
  std::optional<double> offset;  ///< of the tool from the borders, mm; the cutter's radius

  std::string Name() const override { return "pad"; }
  double RimDistance(const ToolpathOptions& options) const override;
  bool IsLaidFromBorders() const override { return true; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
};

}  // namespace millpose
