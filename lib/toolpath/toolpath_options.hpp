// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "toolpath/cutter.hpp"
#include "toolpath/pass_ends.hpp"
#include "toolpath/region.hpp"

namespace millpose {

/// How a tool path is made from a mesh. Everything in the workpiece frame P; mm, rad, mm/s.
struct ToolpathOptions {
  std::string strategy = "parallel_planes";  ///< a name of StrategyNames()
  RegionOptions region;
  Eigen::Vector3d plane_normal = Eigen::Vector3d::UnitX();    ///< parallel_planes: unit vector
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();       ///< rings
  Eigen::Vector3d axis_direction = Eigen::Vector3d::UnitZ();  ///< rings: unit vector
  std::vector<Eigen::Vector3d> curve_points;                  ///< curve: a polyline of two points or more
  Eigen::Vector3d curve_direction =
      Eigen::Vector3d::UnitZ();      ///< curve: projected along it onto faces that face it
  double stepover = 8;               ///< largest distance of neighbouring planes or radii
  bool stepover_on_surface = false;  ///< the step-over is measured along the surface instead
  bool zigzag = true;                ///< every other plane (open ring) is milled the other way
  double chord_tolerance = 0.01;     ///< largest distance of the slice from the chords between points
  double spacing = 5;                ///< largest distance of neighbouring points along the slice
  double crease = DegToRad(30);      ///< a pass ends where the surface bends more sharply
  double lead = 0;                   ///< the tool axis leans forward, towards the feed direction
  double tilt = 0;                   ///< then to the right of the feed direction, seen against the normal
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();  ///< copied to each pass; unit vector
  std::optional<CutterShape> cutter;  ///< moves positions from the contact to the tip where the axis leans
  Layers layers;
  PassEnds ends;
  double feed_rate = 0;  ///< copied to each point
};

}  // namespace millpose
