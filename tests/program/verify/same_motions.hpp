// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/motion_program.hpp"

namespace millpose {

/// Whether two programs take the same way with the same events, seen without any replay.
bool SameMotions(const MotionProgram& a, const MotionProgram& b, const PlanResult& plan);

}  // namespace millpose
