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
Interpreted Interpret(const std::string& program);

/// rs274 accepts `text`, and its canonical moves and speeds are those that `read` has.
void ExpectInterpreted(const std::string& text, const MotionProgram& read);

}  // namespace millpose
