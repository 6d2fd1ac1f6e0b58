// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/pose_settings.hpp"
#include "base/units.hpp"
#include "program/conventions.hpp"
#include "robot/arm.hpp"

namespace millpose {

/// A rail whose motion KRL counts in: it carries the robot, and $WORLD does not move with it.
struct KrlRail {
  PoseSettings pose;                    ///< $ERSYSROOT
  int axis = 1;                         ///< which of the external axes moves the carriage
  FrameAxis direction = FrameAxis::kX;  ///< of $ERSYSROOT, in which the carriage moves
};

/// What of a cell only KRL knows. Every default here and only here; the keys stand in krl_keys.cpp.
struct KrlOptions {
  int base_number = 0, tool_number = 0;            ///< BASE_DATA, TOOL_DATA; 0: values are written
  std::vector<double> external_axes;               ///< E1, E2, …, mm or degrees, constant
  int ptp_speed_percent = 30;                      ///< of the axes' largest speed, between cuts
  int advance = 5;                                 ///< $ADVANCE: motions that are computed ahead
  double orientation_speed = DegToRad(200);        ///< rad/s, as BAS(#INITMOV) sets it
  std::optional<double> orientation_acceleration;  ///< rad/s²; the controller's own where not given
  FrameAxis tool_direction = FrameAxis::kX;        ///< $TOOL_DIRECTION: x, y or z
  std::optional<PoseSettings> robroot;             ///< $ROBROOT; on a coupled rail the robot on its carriage
  std::optional<KrlRail> ersysroot;                ///< a coupled rail
  bool write_load = false;                         ///< $LOAD from the tool's load
  std::string tool_in_spindle;                     ///< variable that holds its number; empty: none
  int memory_kbytes = 4000;                        ///< of all files together
};

/// $ROBROOT as the cell gives it; on a coupled rail the robot's base on the carriage at 0.
Pose KrlRobroot(const KrlOptions& options);
/// The robot's base in $WORLD: $ROBROOT, or, on a coupled rail, $ERSYSROOT · carriage at its place · robot on
/// the carriage.
Pose KrlBase(const KrlOptions& options);
/// By how much (rad) that turns the robot another way against gravity than the cell's X_WB does: the
/// controller's own model of weights rests on it, and $BASE too.
double KrlTilt(const KrlOptions& options, const Pose& X_WB);

}  // namespace millpose
