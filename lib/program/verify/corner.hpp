// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "machine/motion/corner.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// Envelope of the rounding of the corner at which `motion` ends (motion/corner.hpp). `by_distance`: the
/// motion's blend is where rounding may begin, else its blend and angle_blend are bounds of the two
/// deviations.
CornerRounding RoundingOf(const Pose& before, const Pose& corner, const Pose& after, const Motion& motion,
                          bool by_distance);

/// The largest rounding of a joint motion at q that no stop ends (C_PTP): a parabola from half-way before to
/// half-way behind, in joint space, `count` places of it from its begin to its end. How a controller rounds
/// is its own; none begins earlier or ends later.
std::vector<Joints> LargestRounding(const Joints& before, const Joints& q, const Joints& after, int count);
/// How far (rad, joint by joint) that parabola stays from q.
Joints RoundingOfWay(const Joints& before, const Joints& q, const Joints& after);

}  // namespace millpose
