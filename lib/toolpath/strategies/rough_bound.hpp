// SPDX-License-Identifier: GPL-3.0-or-later
// Where the tip may stand in a layer, so that the part keeps its allowance.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "toolpath/cutter.hpp"

namespace millpose {

/// How far the axis of an upright cutter is from where it would come nearer to the part than the allowance,
/// in the plane of a layer. The cutter grown by the allowance meets a part's point at height h when it is
/// nearer to the axis than the grown cutter's radius there; that radius goes up with h, so the part is looked
/// at in bands of height, each with its largest: at most 0.03 mm is left more than that, and only on slopes.
class RoughBound {
 public:
  using Triangle = std::array<Eigen::Vector3d, 3>;

  /// `part` in a frame whose z is the tool axis; the tip runs at `height`, mm.
  RoughBound(const std::vector<Triangle>& part, const CutterShape& cutter, double allowance, double height);

  /// mm, below 0 where the tip may not stand; no more than `most`. Changes by at most 1 mm per mm.
  double Room(const Eigen::Vector2d& place, double most) const;

 private:
  struct Shadow {
    std::vector<Eigen::Vector2d> corners;  ///< convex, or a line, or a point
    double radius;                         ///< of the grown cutter at its height, mm
  };

  void Add(const Triangle& triangle, double low, double high, double radius);
  /// Drops the shadows that one of the widest covers.
  void DropCovered();
  static Bvh TreeOf(const std::vector<Shadow>& shadows);

  std::vector<Shadow> shadows_;
  double largest_ = 0;  ///< of their radii
  Bvh tree_;
};

}  // namespace millpose
