// SPDX-License-Identifier: GPL-3.0-or-later
// The run of a motion program as instants that a controller joins by cubics.
#pragma once

#include <string>
#include <vector>

#include "program/program_time.hpp"

namespace millpose {

/// Where all axes are and how fast: the arm's six in rad, then the external axes in mm or rad, and per s.
struct TrajectoryInstant {
  double time = 0;  ///< s, strictly increasing by at least 1 ns
  Eigen::VectorXd position, rate;
  size_t motion = 0;    ///< of the program, that leads here
  bool at_end = false;  ///< of that motion
};

/// The cubic between two instants at `time`: what ROS's joint_trajectory_controller follows.
Eigen::VectorXd PositionBetween(const TrajectoryInstant& a, const TrajectoryInstant& b, double time);

/// The run by the time law of its motions (TimeMotions), from rest to rest. Between two instants the cubic
/// with their positions and rates leaves the program's path by at most `tolerance` (mm of the tip on the
/// part, above 0): joint motions come out exactly, of straight ones enough instants are taken. A corner that
/// is passed without a stop is rounded by it over as much of both motions as the tolerance allows; the corner
/// itself is an instant. Precondition: every motion has its q and its frame, and X_FT is known.
std::vector<TrajectoryInstant> SampleRun(const MotionProgram& program, const Arm& arm,
                                         const TimeOptions& times, double tolerance);

/// How much of a limit is taken, and where.
struct AxisLoad {
  double share = 0;  ///< 1: all of it
  size_t axis = 0;   ///< 0..5 of the arm, 6 and on external
  size_t at = 0;     ///< which instant
};

/// The largest speed and acceleration of the cubics, in shares of what arm and axes allow.
struct RunLoads {
  AxisLoad speed, acceleration;
};
RunLoads LoadsOf(const std::vector<TrajectoryInstant>& run, const Arm& arm,
                 const std::vector<ExternalAxis>& axes);

/// One sentence for each axis that leaves its limits, for each coupled limit that is not kept, and for each
/// axis that would have to be faster than it can be; the first place of each.
std::vector<std::string> BeyondLimits(const std::vector<TrajectoryInstant>& run, const MotionProgram& program,
                                      const Arm& arm);

}  // namespace millpose
