// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/motion_program.hpp"

namespace millpose {

/// Joints and external axes at a place.
struct AllAxes {
  Joints q = Joints::Zero();
  ExternalPosition external;  ///< empty: they stand where the motion leaves them
};

/// Two motions that overlap at the corner between them: where they begin, meet and end, and what they take.
struct OverlapCorner {
  Joints before = Joints::Zero(), q = Joints::Zero(), after = Joints::Zero();
  double in = 0, out = 0;  ///< s
};

/// How far joints and external axes are from the corner behind motion `i` that a control passes by
/// overlapping (OverlapRounding): all of them for the same time, which the slowest needs to stop. `external`
/// is empty where they stand still.
AllAxes OverlapOf(const MotionProgram& program, size_t i, const OverlapCorner& corner,
                  const Joints& acceleration);

/// The frame that motion `i` counts in, in the robot's base with the external axes beside the motion's end by
/// `off`: empty, or one value for each.
Pose FrameBeside(const MotionProgram& program, size_t i, const ExternalPosition& off);

}  // namespace millpose
