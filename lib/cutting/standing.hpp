// SPDX-License-Identifier: GPL-3.0-or-later
// What material stands when the cutter comes to a point: the stock less what the path has taken off before.
#pragma once

#include "cutting/edge_cut.hpp"
#include "surface/bvh.hpp"
#include "toolpath/milling_point.hpp"
#include "toolpath/region.hpp"

namespace millpose {

/// A region's surface raised by `top` (mm): holds the places above it that are no higher than that, and none
/// beyond its borders. Safe to ask from many threads.
class RaisedRegion {
 public:
  RaisedRegion(const Mesh& mesh, RegionOptions region, double top, double cutter_radius);
  bool Holds(const Eigen::Vector3d& place) const;

 private:
  Mesh mesh_;
  Region region_;
  double top_;
  double beside_;  ///< mm: places this far beside the border still count as over it
  double within_;  ///< mm: no place that is held lies farther from the surface
};

/// The volumes that a cutter sweeps along a tool path, in the order of its points, which are numbered
/// through. Between two points it moves straight; what it passes it clears upwards along its axis. Points
/// with a gouge are not milled.
class SweptPath {
 public:
  SweptPath(const CutterShape& cutter, const Toolpath& toolpath);

  /// A stretch of the path near a place, and how high it runs above it along the place's normal.
  struct Near {
    int motion;
    double height;
  };
  /// What has been swept near `place` when the cutter comes to point `number`, from low to high.
  std::vector<Near> Before(size_t number, const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const;
  /// Whether one of them has taken `place`, `height` above the one they were asked for, off.
  bool Removed(const std::vector<Near>& swept, double height, const Eigen::Vector3d& place) const;

 private:
  struct Motion {
    Eigen::Vector3d from, to, axis;
    size_t number;  ///< of the first point at which it is done
  };
  void Add(const MillingPoint& from, const MillingPoint& to, size_t number);
  bool Takes(const Motion& motion, const Eigen::Vector3d& place) const;

  CutterShape cutter_;
  double drop_ = 0;  ///< mm: no place of the cutter lies lower than this below its tip, seen from near it
  std::vector<Motion> motions_;
  Bvh tree_;
};

}  // namespace millpose
