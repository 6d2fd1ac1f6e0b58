// SPDX-License-Identifier: GPL-3.0-or-later
// Words of a block whose meaning is not known here, or is no motion.
#pragma once

#include <string>

#include "toolpath/cam/gcode_motion.hpp"
#include "toolpath/cam/word_tally.hpp"

namespace millpose {

/// Throws InputError for what has no meaning beside the block's motion, and tells `tally` of the others.
/// `taken`: letters that its words take; `in_cycle`: a drilling cycle is on, or has just ended.
void CheckLeftOver(const GcodeMove& move, const GcodeModes& modes, bool in_cycle, const std::string& taken,
                   WordTally& tally);

/// Fanuc's mode of high speed, G5 P10000 and G5 P0; `p`: its P, −1 without one. LinuxCNC's G5 is a spline:
/// throws InputError.
void CheckHighSpeed(const GcodeMove& move, double p, WordTally& tally);

/// An M code that switches the machine's kinematics, and the job does not say how: throws InputError.
[[noreturn]] void RefuseKinematics(double m, const SourceLocation& place);

}  // namespace millpose
