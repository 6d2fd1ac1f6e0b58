// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategy.hpp"

namespace millpose {

/// A single polyline, projected along a direction onto the first faces that it meets.
struct CurveStrategy final : SurfaceStrategy {
  std::vector<Eigen::Vector3d> points;                        ///< two or more
  Eigen::Vector3d project_along = -Eigen::Vector3d::UnitZ();  ///< the direction of looking; unit vector

  std::string Name() const override { return "curve"; }
  bool IsPrescribed() const override { return true; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
};

}  // namespace millpose
