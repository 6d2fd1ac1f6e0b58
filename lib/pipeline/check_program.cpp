// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/check_program.hpp"

namespace millpose {

ProgramCheck CheckProgram(const MotionProgram& program, const ProgramMotions& motions, const PlanResult& plan,
                          const World& world, const VerifyOptions& options, int threads,
                          std::stop_token stop) {
  ProgramCheck check;
  check.findings = Verify(program, world, &motions.planned, options, threads, std::move(stop));
  if (!check.findings.empty() || motions.planned.notice.empty()) return check;
  check.under_load = ReplayUnderLoad(program, world.cell(), plan);
  CheckUnderLoad(*check.under_load, motions.chord, check.findings);
  return check;
}

}  // namespace millpose
