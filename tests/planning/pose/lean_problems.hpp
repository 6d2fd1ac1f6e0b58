// SPDX-License-Identifier: GPL-3.0-or-later
// Pose problems whose leans are free.
#pragma once

#include "planning/pose/freedoms/lean.hpp"
#include "planning/pose/lean_problem.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {

/// The arm's problem with lead and tilt of a ball cutter of 16 mm between −`most_deg` and `most_deg`.
inline PoseProblem LeaningProblem(double most_deg = 10, double step_deg = 5) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const LeanRange range{DegToRad(-most_deg), DegToRad(most_deg), DegToRad(step_deg), 0};
  problem.freedoms.push_back(std::make_shared<Lead>(range));
  problem.freedoms.push_back(std::make_shared<Tilt>(range));
  problem.lean = LeanRules{.cutter = {8, 8, 40}, .stepover = 3, .surface = nullptr};
  return problem;
}

}  // namespace millpose
