// SPDX-License-Identifier: GPL-3.0-or-later
// What material stands when the cutter comes to a point: the stock less what the path has taken off before.
#pragma once

#include "geometry/mesh/mesh.hpp"
#include "toolpath/engagement/edge_cut.hpp"
#include "toolpath/engagement/stretch_block.hpp"
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

  /// What has been swept near a place when the cutter comes to a point.
  struct Near {
    size_t number = 0;                 ///< of the point
    Eigen::Vector3d place, normal;     ///< its own
    double reach = 0;                  ///< mm along each axis of P: no motion whose tips are farther matters
    std::vector<int> stretches;        ///< of the path
    std::vector<StretchBlock> blocks;  ///< the same, in that order
    int last_taker = -1;               ///< of the motions; it mostly takes the next place too
  };
  /// Near::reach. `above`, mm: how much farther up the tool's axis than the cutter's radius it is asked
  /// about.
  static double Reach(const CutterShape& cutter, double above) { return 2 * cutter.radius + above; }
  Near Before(size_t number, const Eigen::Vector3d& place, const Eigen::Vector3d& normal,
              double above = 0) const;
  /// Whether any of it has taken `place` off, which is no farther from the point than the cutter's radius.
  bool Removed(Near& near, const Eigen::Vector3d& place) const;

 private:
  struct Motion {
    Eigen::Vector3d from, to, axis;
    size_t number;  ///< of the first point at which it is done
  };
  /// Motions one after the other; the halves of a stretch are `half` and `half + 1`. Along a path points may
  /// stand as close as they like: what is asked costs by its length.
  struct Stretch {
    Eigen::AlignedBox3d box;  ///< of the tips
    SweptBar bar;             ///< about them
    int first = 0, count = 0;
    int half = 0;  ///< 0: a single motion
  };
  void Add(const MillingPoint& from, const MillingPoint& to, size_t number);
  void Build(int stretch, int first, int count);
  SweptBar BarOf(int first, int count) const;
  /// Whether most of what is asked about a stretch is answered for all of it.
  bool IsShort(const Stretch& stretch) const;
  bool Takes(const Motion& motion, const Eigen::Vector3d& place) const;
  bool TakesAt(int motion, const Near& near, const Eigen::Vector3d& place) const;
  CutterShape cutter_;
  double drop_ = 0;  ///< mm: no place of the cutter lies lower than this below its tip, seen from near it
  std::vector<Motion> motions_;
  std::vector<Stretch> stretches_;
};

}  // namespace millpose
