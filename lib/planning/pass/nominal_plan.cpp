// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/nominal_plan.hpp"

#include "planning/pose/lean_problem.hpp"

namespace millpose {

PassResult AtNominalLean(const PoseProblem& problem, PassResult plan) {
  if (!HasLean(problem)) return plan;
  for (PlannedPoint& planned : plan.points)
    if (planned.skip == Infeasibility::kNone) planned.point = AtNominalLean(problem, planned.point);
  return plan;
}

}  // namespace millpose
