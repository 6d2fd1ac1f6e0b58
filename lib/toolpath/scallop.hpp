// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "toolpath/cutter.hpp"

namespace millpose {

/// What neighbouring passes leave standing between them. The cutter, led straight on, sweeps out its outline
/// seen along the feed: an ellipse (the flat disc, leaning by `lead`, turned by `tilt`) with the corner
/// radius around it. docs/step-over.md.
class Scallops {
 public:
  Scallops(const CutterShape& cutter, double lead, double tilt) : cutter_(cutter), lead_(lead), tilt_(tilt) {}

  /// The step-over along the surface (mm) that leaves scallops of `height` (mm > 0) on a surface that bends
  /// across the passes by `curvature` (1/mm, positive where it is convex). At most what the cutter covers.
  double Stepover(double height, double curvature) const;

 private:
  double Reach(double height, double curvature, double side) const;
  Eigen::Vector2d Outline(double place, double side) const;

  CutterShape cutter_;
  double lead_, tilt_;
};

}  // namespace millpose
