// SPDX-License-Identifier: GPL-3.0-or-later
// Where a KUKA controller believes the robot to be.
#pragma once

#include "config/cell_settings.hpp"
#include "robot/arm.hpp"

namespace millpose {

/// The robot's base in the controller's $WORLD: $ROBROOT, or, on a coupled rail,
/// $ERSYSROOT · carriage at its place · robot on the carriage.
Pose RobotBaseInWorld(const ControllerSettings& controller);

/// Throws InputError where the controller's frame turns the robot another way against gravity than the cell
/// does: its own model of weights rests on it, and $BASE too.
void CheckGravity(const CellSettings& cell, const ControllerSettings& controller);

}  // namespace millpose
