// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategy.hpp"

namespace millpose {

/// A single polyline, projected onto the part along a direction.
struct CurveStrategy final : SurfaceStrategy {
  std::vector<Eigen::Vector3d> points;                   ///< two or more
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< onto faces that face it; unit vector

  std::string Name() const override { return "curve"; }
  bool IsPrescribed() const override { return true; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
};

}  // namespace millpose
