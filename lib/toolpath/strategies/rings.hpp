// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/strategy.hpp"

namespace millpose {

/// Which coordinate of a ring about an axis stays the same.
enum class RingSurface : uint8_t {
  kAuto,   ///< what suits most of the region's area
  kFaces,  ///< the radius: faces across the axis
  kWalls,  ///< the height: walls around the axis
};

/// What becomes of the rings.
enum class RingPath : uint8_t {
  kClosed,  ///< a closed pass each
  kOpen,    ///< the same, left open
  kSpiral,  ///< one pass inwards or outwards
};

/// Rings and spirals around an axis, on faces across it (by radius) and on walls around it (by height).
struct Rings final : SurfaceStrategy {
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_direction = Eigen::Vector3d::UnitZ();  ///< unit vector
  RingSurface surface = RingSurface::kAuto;
  RingPath path = RingPath::kClosed;
  /// Where the first ring begins, about the axis from the rotation reference, rad; none: there, and rings
  /// that are left open where that costs least.
  std::optional<double> start;
  double seam_step = 0;  ///< where each ring begins, against the one before, rad

  std::string Name() const override { return "rings"; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
  bool IsLaidByScallop() const override { return true; }
};

}  // namespace millpose
