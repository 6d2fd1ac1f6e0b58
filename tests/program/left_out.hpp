// SPDX-License-Identifier: GPL-3.0-or-later
// What leaving points out costs, measured without the economy's own means.
#pragma once

#include "program/motion_program.hpp"

namespace millpose {

/// The farthest that a motion left out of `written` lies from the straight motion that stands for it.
struct LeftOut {
  int count = 0;
  double position = 0;  ///< mm
  double angle = 0;     ///< rad, of the tool's whole orientation
};
/// Fails the running test where `written` is not `planned` without some cut points, in the same order.
LeftOut MeasureLeftOut(const MotionProgram& planned, const MotionProgram& written);

}  // namespace millpose
