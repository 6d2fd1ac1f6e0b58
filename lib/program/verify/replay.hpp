// SPDX-License-Identifier: GPL-3.0-or-later
// Where a program takes the arm.
#pragma once

#include "machine/collision/cell.hpp"
#include "program/programmed_line.hpp"
#include "program/verify/verify.hpp"

namespace millpose {

/// One instant of a replay.
struct Instant {
  Joints q;
  Pose X_BT;          ///< of the cell's real tool
  size_t motion = 0;  ///< into MotionProgram::motions
  double share = 0;   ///< of the motion, 0..1
};

/// The joint position at the end of every motion.
struct Replay {
  std::vector<Joints> targets;
  std::vector<bool> reached;  ///< false where a motion cannot be made; its target is then the one before
};

/// Goes through all motions in order. Motions that cannot be made become findings.
Replay ReplayTargets(const MotionProgram& program, const Cell& cell, std::vector<Finding>& findings);

/// Appends the instants of motion `index` after its start, about `step` mm of tip travel (or 0.5° of turning)
/// apart, the last one its target. A straight motion that leaves its branch or reach becomes a finding and
/// ends there.
void AppendInstants(const MotionProgram& program, const Cell& cell, const Replay& replay, size_t index,
                    double step, std::vector<Instant>& instants, std::vector<Finding>& findings);

/// In how many parts of `length` (mm) or `angle` (rad) the external axes move in motion `index`; 0 where they
/// stand still.
double ExternalParts(const MotionProgram& program, size_t index, double length, double angle);

/// The straight motion `index` in P as the control may also turn the tool (MotionProgram::any_turn); empty
/// where there is but one way.
std::vector<ProgrammedLine> OtherWays(const MotionProgram& program, const Replay& replay, const Cell& cell,
                                      size_t index);
/// X_BT of the cell's real tool where the program believes its own to be at X_PT at `share` of motion
/// `index`.
Pose RealTool(const MotionProgram& program, const Cell& cell, size_t index, double share, const Pose& X_PT);

/// A finding at a motion of `program`.
Finding At(const MotionProgram& program, size_t motion, Cause cause, std::string message);

}  // namespace millpose
