// SPDX-License-Identifier: GPL-3.0-or-later
// What no milling program lacks, whatever its plan.
#pragma once

#include "program/verify/compare.hpp"

namespace millpose {

/// What is wrong with a program that is known without its plan: the spindle stands still in a cut or turns at
/// the end, a cut that does not end as one (no mark of its end, no stop before the way), the last motion in
/// one, calls that belong into a text of the cell, speeds above those that its own header states, no check of
/// the controller's frame (`own_world`: the controller has one).
std::vector<Finding> CheckStandingAlone(const MotionProgram& program, const Cell& cell, bool own_world,
                                        const VerifyOptions& options);

/// "reach, limits, speeds, singularity, interference, spindle; not the plan", and what the program or its
/// cell lacks for more.
std::string ScopeOf(const MotionProgram& program);

}  // namespace millpose
