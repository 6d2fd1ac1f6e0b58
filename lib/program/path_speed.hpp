// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/motion/corner.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// A motion of a cut that cannot hold its feed.
struct SlowPlace {
  size_t motion = 0;          ///< at whose end the corner is, or that is too short
  double feed = 0;            ///< mm/s, programmed
  double speed = 0;           ///< mm/s, estimated
  bool short_motion = false;  ///< the control has less than its shortest time per motion; else the corner
};

/// What the controller makes of the feeds of a program. An estimate (motion/corner.hpp).
struct SpeedEstimate {
  double lowest_share = 1;        ///< of the programmed feed, in cuts between their planned stops
  std::vector<SlowPlace> places;  ///< where it is below 1, in order
};

/// Estimates the speed along the cuts of a program as written: at every rounded corner and in every motion
/// between. `blend` of the motions is a distance, or, where the program's blend_is_distance is false, how far
/// the corner may be left (then `angle_blend` bounds the orientation; 0: nothing does). Planned stops, and
/// how long the tool needs to reach its speed behind them, do not count. Nothing faster than `wanted` (mm/s)
/// is asked for; 0: the programmed feed.
SpeedEstimate EstimateSpeed(const MotionProgram& program, const PathDynamics& dynamics, double wanted = 0);

}  // namespace millpose
