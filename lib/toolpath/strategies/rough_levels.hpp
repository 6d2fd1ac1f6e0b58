// SPDX-License-Identifier: GPL-3.0-or-later
// What strategy rough knows of stock and part in the frame of its tool axis.
#pragma once

#include "toolpath/strategies/rough.hpp"
#include "toolpath/strategies/rough_bound.hpp"
#include "toolpath/strategies/rough_material.hpp"

namespace millpose {

/// Stock and part seen along the tool axis: x and y across it, z along it, all from P's origin; mm.
struct RoughScene {
  Eigen::Matrix3d across;  ///< rows: the frame's axes in P
  std::vector<RoughBound::Triangle> part;
  RoughGrid grid;           ///< over the stock and as far round it as the cutter's axis may go
  std::vector<float> tops;  ///< how high stock stands by cell
};

/// `axis`: from tip to holder, unit. Throws InputError for stock without material and a lattice of more than
/// 30 million cells.
RoughScene RoughSceneOf(const StrategyInputs& inputs, const Eigen::Vector3d& axis);

/// Heights of the tip, downwards: an allowance over each plane face of the part that lies across the axis,
/// and at the lowest place, with layers of even depth between them. Throws InputError where that leaves no
/// layer.
std::vector<double> RoughLevels(const Rough& rough, const RoughScene& scene);

/// The radius of a cutter's plane floor.
inline double RoughDisc(const CutterShape& cutter) { return cutter.radius - cutter.corner_radius; }

}  // namespace millpose
