// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/motion_program.hpp"
#include "program/programmed_line.hpp"

namespace millpose {

struct EconomyOptions {
  double position_tolerance = 0.01;        ///< mm
  double angle_tolerance = 0.00034906585;  ///< rad (0.02°), of the tool's whole orientation
  double spacing = 0;                      ///< mm: nearer points starve the controller's look-ahead; 0: any
  /// How the controller may make a straight motion; all must stay near. Empty: with one even turn.
  std::vector<LineModel> lines = {};
};

struct EconomyResult {
  MotionProgram program;
  std::vector<size_t> origin;  ///< of each motion that remains: its index before
  int saved = 0;               ///< points left out
  int near = 0;  ///< points that remain nearer than `spacing` to the one before: the tolerances need them
};

/// Leaves out cut points between which the controller's own straight motion stays within the tolerances of
/// every point left out, and external axes that move along within those of where they are planned to be there
/// (mm and rad as of the tip and the orientation). First and last point of a piece, exact stops, changes of
/// the feed and places where something happens remain. Greedy: each motion is about as long as it can be, but
/// where the last one before a point that must remain came out shorter than the spacing, the point before is
/// moved back if the tolerances allow it.
EconomyResult Economise(const MotionProgram& program, const EconomyOptions& options);

/// Makes exact stops of cut points so that no more than `most` motions follow each other without one, and
/// marks the places as handovers, where another file may go on. Returns the motions before which they are.
std::vector<size_t> AddHandovers(MotionProgram& program, int most);

/// Entries at which a joint stands nearer to 0 than `least` (rad, controller's angles) become joint angles:
/// there a turn bit does not say for certain which way the joint goes. Returns their indices.
std::vector<size_t> StateEntriesByJoints(MotionProgram& program, const AxisConvention& axes, double least);

}  // namespace millpose
