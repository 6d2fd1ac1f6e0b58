// SPDX-License-Identifier: GPL-3.0-or-later
// How long a program takes, and where the arm is at every time of it.
#pragma once

#include <string>
#include <vector>

#include "machine/motion/time_law.hpp"
#include "planning/result/cycle_time.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// What a controller adds to the arm's own limits.
struct TimeOptions {
  double way_speed_share = 1;    ///< of the axes' largest speeds, in joint motions between cuts
  double orientation_speed = 0;  ///< rad/s, largest turning of the tool in straight motions; 0: no such limit
  double way_tip_speed = 0;      ///< mm/s of the tip, in joint motions between cuts; 0: no such limit
  double way_turn_speed = 0;     ///< rad/s, turning of the tool, likewise
};

/// The time law of every motion: joint motions between cuts, and those of the external axes, as fast as the
/// axes allow (FastestLaw), motions
/// with a feed at it, no faster than the tool, external axes that move along, or, where it only turns, half
/// of the axes' speeds allow. Each speeds up after and slows down before an exact stop with the slowest
/// axis's acceleration. Corners that are rounded are passed at the feed. Precondition: every motion has its
/// q.
std::vector<TimeLaw> TimeMotions(const MotionProgram& program, const Arm& arm, const TimeOptions& options);

/// What TimeMotions adds up to.
ProgramTime MeasureTime(const MotionProgram& program, const Arm& arm, const TimeOptions& options);

/// The tool in the workpiece frame, X_PT, and the joints at `share` (0..1) of the way of motion `i`; of the
/// first motion: where it ends. Precondition as above, and the program has its frames.
Pose TipOf(const MotionProgram& program, const Arm& arm, size_t i, double share);
Joints JointsOf(const MotionProgram& program, const Arm& arm, size_t i, double share);

/// A motion from one point of a cut to the next; the one that ends at its first point is the plunge.
bool IsCut(const MotionProgram& program, size_t i);

/// A column of the trajectory for an axis beside the arm's six.
struct ExternalColumn {
  std::string name;            ///< with its unit
  std::optional<size_t> axis;  ///< of MotionProgram::external_axes; empty: it stands still
  double constant = 0;         ///< mm or degrees, where it does
};

/// CSV of the whole program: time, joints, external axes, tip in W, speed, pass, piece; a row at the end of
/// every motion and every `seconds` s between. Angles deg, arm's convention; tip A, B, C about Z, Y', X'';
/// its speed against the part. `X_WB`: with all external axes at 0.
std::string TrajectoryCsv(const MotionProgram& program, const Arm& arm, const Pose& X_WB,
                          const std::vector<ExternalColumn>& external, const TimeOptions& options,
                          double seconds);

}  // namespace millpose
