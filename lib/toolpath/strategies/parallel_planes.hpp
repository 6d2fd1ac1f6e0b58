// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategy.hpp"

namespace millpose {

/// Slices by parallel planes.
struct ParallelPlanes final : SurfaceStrategy {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< of the planes, unit vector

  std::string Name() const override { return "parallel_planes"; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
  bool IsLaidByScallop() const override { return true; }
};

}  // namespace millpose
