// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <utility>

#include "toolpath/cutter.hpp"

namespace millpose {

/// What neighbouring passes leave standing between them. The cutter, led straight on, sweeps out its outline
/// seen along the feed: an ellipse (the flat disc, leaning by `lead`, turned by `tilt`) with the corner
/// radius around it. docs/step-over.md.
class Scallops {
 public:
  /// `back_and_forth`: every other pass runs the other way, so that a tilted cutter leans away from one of
  /// its neighbours and towards the other.
  Scallops(const CutterShape& cutter, double lead, double tilt, bool back_and_forth)
      : cutter_(cutter), lead_(lead), tilt_(tilt), back_and_forth_(back_and_forth) {}

  /// The step-over along the surface (mm) that leaves scallops of `height` (mm > 0) on a surface that bends
  /// across the passes by `curvature` (1/mm, positive where it is convex). At most what the cutter covers.
  /// Back and forth: the smaller one of the two that alternate.
  double Stepover(double height, double curvature) const;

  /// How far from the contact along the surface (mm) the outline rises to `height`: to the left and to the
  /// right of the feed, the smaller one for both when back and forth.
  std::pair<double, double> Reaches(double height, double curvature) const;
  /// Whether the outline lies no higher than `height` up to these ways to the left and to the right.
  bool Covers(double height, double curvature, double left, double right) const;

 private:
  double Reach(double height, double curvature, double side) const;
  Eigen::Vector2d Outline(double place, double side) const;
  bool CoversSide(const Eigen::Vector2d& place, double side) const;

  CutterShape cutter_;
  double lead_, tilt_;
  bool back_and_forth_;
};

}  // namespace millpose
