// SPDX-License-Identifier: GPL-3.0-or-later
// What a cutter leaves standing of the material over a surface (docs/face.md).
#pragma once

#include <limits>
#include <stop_token>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "toolpath/cutter.hpp"
#include "toolpath/stock/surface_rays.hpp"

namespace millpose {

/// Where a cutter is: its tip (the lowest point on the axis), mm, and its axis from tip to holder, unit.
struct CutterPlace {
  Eigen::Vector3d tip, axis;
};

/// From one place to the next: the tip on a line, the axis turning evenly.
struct CutterMotion {
  CutterPlace from, to;
  int pass = 0;
};

/// What one tool takes off, in P; the cutter's length is its cutting length.
struct CutsOfTool {
  CutterShape cutter;
  std::vector<CutterMotion> motions;
};

/// The height along a ray's normal to which material stands, mm from its origin.
struct RayHeight {
  double height = std::numeric_limits<double>::infinity();
  int motion = -1;  ///< the one that cut it down to there; −1: none came near

  bool IsCut() const { return motion >= 0; }
};

/// The volume that a cutter takes off along motions, whose order does not matter. All above its lower side
/// counts as taken off, along its axis; material is asked for within `band` (mm) of the surface, and tools
/// whose axis points against a ray's normal are none of its own. Immutable, so threads may share it.
class SweptCutter {
 public:
  /// `band` is at least the cutter's radius.
  SweptCutter(const CutterShape& cutter, std::vector<CutterMotion> motions, double band);

  /// Down to where material stands along a ray. Exact to 1e-8 mm for the given motions; where an axis turns,
  /// to 7e-8 of the radius, since along a stretch it follows the chord.
  RayHeight HeightOn(const SurfaceRay& ray) const;
  /// The same for many. Throws Interrupted.
  std::vector<RayHeight> HeightsOn(const std::vector<SurfaceRay>& rays, int threads,
                                   std::stop_token stop = {}) const;

  const std::vector<CutterMotion>& motions() const { return motions_; }

 private:
  /// A motion, or a part of one along which the axis hardly turns.
  struct Stretch {
    Eigen::Vector3d tip, way, axis, turn;  ///< at its beginning, and by how much they change
    int motion;
  };
  /// The cutter's core at one place: what is left of it when a ball of the corner radius rolls inside.
  struct Nearest {
    double share = 0;         ///< of the stretch
    double distance = 0;      ///< of the core from a place, mm
    Eigen::Vector3d towards;  ///< from the core to the place
    double slope = 0;         ///< of half the squared distance by the share
  };

  void Add(const CutterMotion& motion, int number);
  Nearest At(const Stretch& stretch, double share, const Eigen::Vector3d& place) const;
  Nearest NearestAlong(const Stretch& stretch, const Eigen::Vector3d& place) const;
  double LowestPossible(const Stretch& stretch, const SurfaceRay& ray) const;
  /// Where the ray enters the stretch's volume from below, if that is below `limit`; else `limit`.
  double Entry(const Stretch& stretch, const SurfaceRay& ray, double limit) const;

  CutterShape cutter_;
  std::vector<CutterMotion> motions_;
  double band_;
  std::vector<Stretch> stretches_;
  Bvh tree_;
};

}  // namespace millpose
