// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/motion/corner.hpp"
#include "program/post.hpp"

namespace millpose {

/// Sets, piece by piece, how far the tip may leave rounded corners (`blend` of the straight motions, G64 P):
/// as far as the settings' tolerance goes, less where the rotary joints would overlap by so much that the
/// orientation left it, since G64 bounds X, Y, Z alone and shortens the overlap of all joints by what it
/// allows them. Precondition: every motion has its joints.
void ChooseOverlap(MotionProgram& program, const Arm& arm, const PostSettings& settings, bool cartesian);

/// s that LinuxCNC takes for the straight motion `i`: by the feed, or, where it only turns, at half of the
/// axes' largest speeds; at no more than those of external axes that move along.
double LinearDuration(const MotionProgram& program, size_t i, const Arm& arm);

}  // namespace millpose
