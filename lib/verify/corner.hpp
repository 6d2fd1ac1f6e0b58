// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/motion_program.hpp"

namespace millpose {

/// How far a rounded corner may leave the corner itself.
struct CornerRounding {
  double position = 0;  ///< mm
  double angle = 0;     ///< rad
};

/// Envelope of the rounding of the corner at which `motion` ends. Rounding begins at most half a segment
/// before the corner and ends at most half a segment behind it; with tangents of length d on both sides the
/// farthest that a parabola stays from the corner is d/4·|u₂ − u₁|, u the directions (and, for the
/// orientation, the rotations per mm). `by_distance`: the motion's blend is d, else its blend and angle_blend
/// are bounds of the two deviations.
CornerRounding RoundingOf(const Pose& before, const Pose& corner, const Pose& after, const Motion& motion,
                          bool by_distance);

}  // namespace millpose
