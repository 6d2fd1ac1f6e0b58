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

/// How far (rad, joint by joint) the joints are from a corner that a control passes by overlapping the
/// slowing down of one motion with the speeding up of the next (LinuxCNC): a parabola over the time t that
/// the slowest joint needs to stop, no longer than the shorter motion takes, leaves it by t/8 of the change
/// of speed. Speeds in rad/s, `shorter` in s.
Joints OverlapRounding(const Joints& before, const Joints& after, const Joints& acceleration, double shorter);

}  // namespace millpose
