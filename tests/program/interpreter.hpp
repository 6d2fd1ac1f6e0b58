// SPDX-License-Identifier: GPL-3.0-or-later
// The real interpreter of LinuxCNC (rs274).
#pragma once

#include <string>

#include "program/motion_program.hpp"

namespace millpose {

struct Interpreted {
  int status = -1;
  std::string canonical;
};
/// `nine_axes`: for a machine with U, V and W, by nine_axes.py; else rs274 itself.
Interpreted Interpret(const std::string& program, bool nine_axes = false);

/// The interpreter accepts `text`, and its canonical moves and speeds are those that `read` has, whose
/// external axes are U, V, W in this order.
void ExpectInterpreted(const std::string& text, const MotionProgram& read);

}  // namespace millpose
