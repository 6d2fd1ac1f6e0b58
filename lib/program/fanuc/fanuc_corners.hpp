// SPDX-License-Identifier: GPL-3.0-or-later
// Corners that are passed without a stop: CNTn and CRy, whose paths the maker does not document.
#pragma once

#include "program/fanuc/fanuc_options.hpp"

namespace millpose {

/// What such a corner is taken to stay within (MotionProgram::corner_assumption); empty where the cell knows
/// nothing that bounds one: corners are then passed at CNT0.
std::string FanucCornerAssumption(const FanucOptions& options, const PostSettings& settings);

/// Sets `blend` of every corner of a cut: how far before and behind it the path may be another, 0 at CNT0. It
/// is that of CNT100, or of the widest CRy, whose bound stays within the cell's max_corner_mm and the
/// settings' tolerance of the orientation.
void ChooseFanucCorners(MotionProgram& program, const FanucOptions& options, const PostSettings& settings);

/// "FINE", "CNT0", "CNT100", "CR2".
std::string FanucTermination(const Motion& motion, const FanucOptions& options);

/// Of a program as read: its blends are those of the text, y of CRy or any number above 0 of CNTn; they
/// become distances.
void SettleFanucCorners(MotionProgram& program, const FanucOptions& options);

}  // namespace millpose
