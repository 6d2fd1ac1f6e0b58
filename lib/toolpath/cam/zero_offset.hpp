// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/cam/gcode_motion.hpp"

namespace millpose {

/// G54 to G59.3, G154, G500, G505 to G599.
bool IsZeroOffset(double g);

/// The name of a block's zero offset ("G54", "G54.1 P2"); `moves`: G0 to G3 stand beside it. Throws
/// InputError for an extended one without its number, and for G58 and G59 with coordinates where they shift
/// the frame, or may do so.
std::string ZeroOffsetOf(const GcodeWord& word, const GcodeMove& move, bool moves, const SenderRules& rules,
                         const GcodeMotion::ValueOf& value_of);

}  // namespace millpose
