// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "surface/curve.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// The curves of one plane, radius or contour, milled one after the other.
struct Lane {
  std::vector<Curve> curves;  ///< on the mesh
  /// What grows along the lane: parts that the region cuts off are milled in ascending order of it. Empty: in
  /// the order of `curves`.
  std::function<double(const Eigen::Vector3d&)> progress;
  /// What grows from lane to lane, from milled to unmilled: tells climb from conventional milling. Empty
  /// where a lane has no neighbours.
  std::function<double(const Eigen::Vector3d&)> advance;
  bool backwards = false;  ///< in a zigzag: against the curves' direction; closed passes keep theirs
  bool clipped = false;    ///< the curves lie in the region as they are
  bool oriented = false;   ///< the curves run as climb or conventional asks for
};

/// What a strategy makes of a region.
struct Layout {
  std::vector<Lane> lanes;  ///< in the order of milling
  /// Of a plane region: the normal of all its points. Else they have the surface's, which near a fillet lean
  /// towards it.
  std::optional<Eigen::Vector3d> normal;
  std::vector<std::string> notes;  ///< what the user should know, one sentence each
};

/// A way to cover a region with curves. An implementation is one file and one line in strategy.cpp.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// Throws InputError for a region that the strategy cannot cover; Interrupted.
  virtual Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const = 0;
};

/// All strategies by name, sorted.
std::vector<std::string> StrategyNames();

/// Throws InputError with the nearest name for an unknown one.
std::unique_ptr<Strategy> MakeStrategy(const std::string& name);

std::unique_ptr<Strategy> MakeContours();
std::unique_ptr<Strategy> MakePad();
std::unique_ptr<Strategy> MakeParallelPlanes();
std::unique_ptr<Strategy> MakeRings();
std::unique_ptr<Strategy> MakeSingleCurve();

}  // namespace millpose
