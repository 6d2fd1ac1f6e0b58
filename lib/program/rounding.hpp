// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/motion/corner.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// Sets from how far before their corners the straight motions are rounded (`blend`, a distance): in every
/// piece the largest distance at which each of its corners stays within the tolerance, and another one where
/// a corner would have less than half of what it could. A corner that stays within tolerance even where its
/// rounding reaches the middle of the shorter motion, beyond which it never reaches, bounds nothing. Exact
/// stops have none.
void ChooseRounding(MotionProgram& program, const PathTolerance& tolerance);

}  // namespace millpose
