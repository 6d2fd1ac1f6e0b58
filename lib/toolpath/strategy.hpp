// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "surface/curve.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// The curves of one plane, radius or contour, milled one after the other.
struct Lane {
  std::vector<Curve> curves;  ///< on the mesh, not yet clipped to the region
  /// What grows along the lane: parts that the region cuts off are milled in ascending order of it.
  std::function<double(const Eigen::Vector3d&)> progress;
  bool backwards = false;  ///< mill against the curves' direction (zigzag); closed passes keep theirs
};

/// A way to cover a region with curves. An implementation is one file and one line in strategy.cpp.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// The lanes in the order of milling. Throws Interrupted.
  virtual std::vector<Lane> Lanes(const Mesh& mesh, const Region& region, const ToolpathOptions& options,
                                  std::stop_token stop) const = 0;
};

/// All strategies by name, sorted.
std::vector<std::string> StrategyNames();

/// Throws InputError with the nearest name for an unknown one.
std::unique_ptr<Strategy> MakeStrategy(const std::string& name);

std::unique_ptr<Strategy> MakeContours();
std::unique_ptr<Strategy> MakeParallelPlanes();
std::unique_ptr<Strategy> MakeRings();
std::unique_ptr<Strategy> MakeSingleCurve();

}  // namespace millpose
