// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/pose_settings.hpp"
#include "base/units.hpp"
#include "program/post.hpp"

namespace millpose {

/// A rail whose motion KRL counts in: it carries the robot, and $WORLD does not move with it.
struct KrlRail {
  PoseSettings pose;                    ///< $ERSYSROOT
  FrameAxis direction = FrameAxis::kX;  ///< of $ERSYSROOT, in which the carriage moves
};

/// A table whose motion KRL counts in ("external kinematic"): $BASE moves with it.
struct KrlTable {
  int machine_def = 2;  ///< number in MACHINE_DEF
  PoseSettings root;    ///< its ROOT, in $WORLD
  PoseSettings flange;  ///< the table's own frame in ROOT with its axes at 0
};

/// What of a cell only KRL knows. Every default here and only here; the keys stand in krl_keys.cpp.
struct KrlOptions {
  int base_number = 0, tool_number = 0;            ///< BASE_DATA, TOOL_DATA; 0: values are written
  int ptp_speed_percent = 30;                      ///< of the axes' largest speed, between cuts
  int advance = 5;                                 ///< $ADVANCE: motions that are computed ahead
  double orientation_speed = DegToRad(200);        ///< rad/s, as BAS(#INITMOV) sets it
  std::optional<double> orientation_acceleration;  ///< rad/s²; the controller's own where not given
  FrameAxis tool_direction = FrameAxis::kX;        ///< $TOOL_DIRECTION: x, y or z
  std::optional<PoseSettings> robroot;             ///< $ROBROOT; on a coupled rail the robot on its carriage
  std::optional<KrlRail> ersysroot;                ///< a coupled rail
  std::optional<KrlTable> external_base;           ///< coupled axes that carry the workpiece
  std::optional<bool> write_load;                  ///< $LOAD from the tool's load, see WritesLoad()
  std::string tool_in_spindle;                     ///< variable that holds its number; empty: none
  int memory_kbytes = 4000;                        ///< of all files together

  /// Where the cell does not say so, a numbered tool of the controller brings its own load data.
  bool WritesLoad() const { return write_load.value_or(tool_number == 0); }
};

/// $ROBROOT as the cell gives it; on a coupled rail the robot's base on the carriage at 0.
Pose KrlRobroot(const KrlOptions& options);
/// The robot's base in $WORLD as the controller believes it, with the cell's external axes at `external`
/// (empty: at 0): $ROBROOT, or, on a coupled rail, $ERSYSROOT · carriage at its place · robot on the
/// carriage.
Pose KrlBase(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external = {});
/// By how much (rad) that turns the robot another way against gravity than the cell's X_WB does: the
/// controller's own model of weights rests on it, and $BASE too.
double KrlTilt(const KrlOptions& options, const PostSettings& settings);
/// The name of the coupled axis that carries the robot; empty where there is none.
std::string KrlCarriage(const PostSettings& settings);
/// Where the controller has the table's own frame, in $WORLD. Precondition: it counts in a table.
Pose KrlTableFrame(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external);
/// What $BASE is given for the base frame X_BP in the robot's base: the frame in $WORLD, or, where the
/// controller counts in a table, on that. And the base frame of such a value.
Pose KrlBaseValue(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external,
                  const Pose& X_BP);
Pose KrlBaseFrame(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external,
                  const Pose& value);
/// Why the cell's external axes do not go with ersysroot and external_base; empty where they do.
std::string KrlWhyNotWithAxes(const KrlOptions& options, const PostSettings& settings);

}  // namespace millpose
