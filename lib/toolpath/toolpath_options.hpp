// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "toolpath/budget.hpp"
#include "toolpath/cutter.hpp"
#include "toolpath/pass_ends.hpp"
#include "toolpath/path_section.hpp"
#include "toolpath/region.hpp"
#include "toolpath/tool_axis.hpp"

namespace millpose {

/// Which way passes are milled.
enum class Direction : uint8_t {
  kZigzag,        ///< every other one backwards
  kOneWay,        ///< all the same way
  kClimb,         ///< unmilled material on the right of a cutter that turns clockwise seen from its holder
  kConventional,  ///< on the left of it
};

class Strategy;

/// How a tool path is made from a mesh. Everything in the workpiece frame P; mm, rad, mm/s.
struct ToolpathOptions {
  std::shared_ptr<const Strategy> strategy;  ///< which also holds the options that are its own
  RegionOptions region;
  std::optional<PathSection> share;  ///< none: the whole path
  double stepover = 0;  ///< largest distance of neighbouring planes or radii; not for prescribed lines
  bool stepover_on_surface = false;  ///< the step-over is measured along the surface instead
  double scallop = 0;                ///< above 0: passes as far apart as leaves scallops of this height
  Direction direction = Direction::kZigzag;
  bool order_by_travel = false;   ///< passes in the order of short ways between them
  double chord_tolerance = 0.01;  ///< largest distance of the slice from the chords between points
  double spacing = 5;             ///< largest distance of neighbouring points along the slice
  int parts = 1;                  ///< that each such step is cut into, a power of two
  double crease = DegToRad(30);   ///< a pass ends where the surface bends more sharply
  double normal_smoothing = 0;    ///< length over which normals are averaged
  ToolAxisOptions tool_axis;
  double lead = 0;  ///< the tool axis leans forward, towards the feed direction
  double tilt = 0;  ///< then to the right of the feed direction, seen against the normal
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();  ///< copied to each pass; unit vector
  /// Moves positions from the contact to the tip where the axis leans; scallops and pads need it too.
  CutterShape cutter;
  bool centre_cutting = true;      ///< the cutter may go straight down into material
  double max_ramp = DegToRad(90);  ///< rad, of a ramp or helix by which it may enter material
  Layers layers;
  PassEnds ends;
  double feed_rate = 0;     ///< copied to each point
  double plunge_feed = 0;   ///< along the tool axis into the material; 0: the feed rate
  double retract_feed = 0;  ///< along it out of the material; 0: the feed rate
  PointBudget budget;
  /// Of a ball's cutting speed at the nominal lean, where the pose search leans the tool.
  double min_cutting_speed_share = 0.3;
};

}  // namespace millpose
