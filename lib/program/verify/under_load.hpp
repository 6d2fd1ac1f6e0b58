// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/collision/cell.hpp"
#include "planning/result/plan_result.hpp"
#include "program/motion_program.hpp"
#include "program/verify/verify.hpp"

namespace millpose {

/// How well a program carries a plan's compensation.
struct UnderLoad {
  double largest = 0;  ///< mm along the normal: how far the loaded tip is from where the plan expects it
  int pass = -1, point = -1;  ///< where
};

/// Replays a program with the expected deflection on its tip: at each compensated point, how far the loaded
/// tip lies along the surface normal from where the plan says that it comes to lie (the nominal point plus
/// what was not taken out). Precondition: Verify() confirmed the program against the plan's commanded
/// motions.
UnderLoad ReplayUnderLoad(const MotionProgram& program, const Cell& cell, const PlanResult& plan);

/// Adds a finding where that is more than `chord` (mm, by which points left out may lie beside the way) and a
/// micrometre: verification's tolerance of the path alone would let a program without its shifts pass.
void CheckUnderLoad(const UnderLoad& found, double chord, std::vector<Finding>& findings);

}  // namespace millpose
