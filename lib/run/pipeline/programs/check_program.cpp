// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/check_program.hpp"

namespace millpose {

ProgramCheck CheckProgram(const MotionProgram& program, const ProgramMotions& motions, const PlanResult& plan,
                          const Programming& with) {
  ProgramCheck check;
  check.findings = Verify(program, with.world, &motions.planned, with.options, with.execution);
  check.but_for = FindCornerBound(program, with.world.cell());
  if (!check.findings.empty() || !motions.commanded) return check;
  check.under_load = ReplayUnderLoad(program, with.world.cell(), plan);
  CheckUnderLoad(*check.under_load, motions.chord, check.findings);
  return check;
}

}  // namespace millpose
