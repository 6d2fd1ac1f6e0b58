// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "toolpath/budget.hpp"
#include "toolpath/cutter.hpp"
#include "toolpath/pass_ends.hpp"
#include "toolpath/region.hpp"

namespace millpose {

/// Which way passes are milled.
enum class Direction : uint8_t {
  kZigzag,        ///< every other one backwards
  kOneWay,        ///< all the same way
  kClimb,         ///< unmilled material on the right of a cutter that turns clockwise seen from its holder
  kConventional,  ///< on the left of it
};

/// Which coordinate of a ring about an axis stays the same.
enum class RingSurface : uint8_t {
  kAuto,   ///< what suits most of the region's area
  kFaces,  ///< the radius: faces across the axis
  kWalls,  ///< the height: walls around the axis
};

/// How a tool path is made from a mesh. Everything in the workpiece frame P; mm, rad, mm/s.
struct ToolpathOptions {
  std::string strategy = "parallel_planes";  ///< a name of StrategyNames()
  RegionOptions region;
  Eigen::Vector3d plane_normal = Eigen::Vector3d::UnitX();    ///< parallel_planes: unit vector
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();       ///< rings
  Eigen::Vector3d axis_direction = Eigen::Vector3d::UnitZ();  ///< rings: unit vector
  RingSurface ring_surface = RingSurface::kAuto;
  bool spiral = false;   ///< rings, pad: one pass inwards or outwards
  double seam_step = 0;  ///< rings: where each begins, against the one before
  Eigen::Vector3d pad_direction = Eigen::Vector3d::UnitX();  ///< pad: along it the lines run; unit vector
  std::optional<double> pad_offset;           ///< pad: of the tool from the borders; the cutter's radius
  std::vector<Eigen::Vector3d> curve_points;  ///< curve: a polyline of two points or more
  Eigen::Vector3d curve_direction =
      Eigen::Vector3d::UnitZ();      ///< curve: projected along it onto faces that face it
  double stepover = 8;               ///< largest distance of neighbouring planes or radii
  bool stepover_on_surface = false;  ///< the step-over is measured along the surface instead
  double scallop = 0;                ///< above 0: passes as far apart as leaves scallops of this height
  Direction direction = Direction::kZigzag;
  bool order_by_travel = false;   ///< passes in the order of short ways between them
  double chord_tolerance = 0.01;  ///< largest distance of the slice from the chords between points
  double spacing = 5;             ///< largest distance of neighbouring points along the slice
  double crease = DegToRad(30);   ///< a pass ends where the surface bends more sharply
  double normal_smoothing = 0;    ///< length over which normals are averaged
  double lead = 0;                ///< the tool axis leans forward, towards the feed direction
  double tilt = 0;                ///< then to the right of the feed direction, seen against the normal
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();  ///< copied to each pass; unit vector
  /// Moves positions from the contact to the tip where the axis leans; scallops and pads need it too.
  CutterShape cutter;
  Layers layers;
  PassEnds ends;
  double feed_rate = 0;  ///< copied to each point
  PointBudget budget;
};

}  // namespace millpose
