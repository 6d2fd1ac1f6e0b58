// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/verify/corner_bound.hpp"
#include "program/verify/under_load.hpp"
#include "run/pipeline/programs/program_motions.hpp"
#include "run/pipeline/programs/programming.hpp"

namespace millpose {

/// A program as read back, held against the motions that it was written from.
struct ProgramCheck {
  std::vector<Finding> findings;        ///< empty: confirmed
  std::optional<UnderLoad> under_load;  ///< of a compensated plan, where the replay found nothing
  std::optional<CornerBound> but_for;   ///< for which alone it is confirmed
};

/// Verify(), and for a compensated plan whether the program carries its shifts.
ProgramCheck CheckProgram(const MotionProgram& program, const ProgramMotions& motions, const PlanResult& plan,
                          const Programming& with);

}  // namespace millpose
