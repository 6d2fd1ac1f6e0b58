// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/motion_program.hpp"
#include "program/programmed_line.hpp"

namespace millpose {

/// What turns of straight motions are bounded by.
struct TurnBound {
  std::vector<LineModel> lines;            ///< how the controller may make them; all must stay near
  double angle_tolerance = 0.00034906585;  ///< rad, from the even turn that was planned
};

/// Inserts points into straight motions of `written` whose orientation the controller would take further off
/// the planned, even turn. `origin`: the planned motion that each one ends with, see EconomyResult; an
/// inserted point has that of the motion it is part of, and no `point`. Motions that stand for several
/// planned ones are the economy's own and stay as they are. Returns how many points were inserted.
int BoundTurns(MotionProgram& written, std::vector<size_t>& origin, const Arm& arm, const TurnBound& bound);

}  // namespace millpose
