// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/inputs.hpp"
#include "program/economy.hpp"
#include "program/program_time.hpp"
#include "report/report.hpp"

namespace millpose {

/// The motions of a plan for one controller.
struct ProgramMotions {
  MotionProgram planned;   ///< every point of the plan: what a program is verified against
  MotionProgram written;   ///< what is given to the post: without needless points
  bool commanded = false;  ///< elsewhere than planned: shifts or the arm's deviations are taken out
  int saved = 0;           ///< points that `written` leaves out
  int inserted = 0;        ///< points that `written` adds so that the tool turns as planned
  double chord = 0;        ///< mm, by which a point left out may lie beside the way
  int near = 0;            ///< points that remain nearer than the least spacing
  std::vector<std::string> warnings;  ///< handovers in a cut
  ProgramTime time;                   ///< of `written`
};

/// The motions of a plan as they are run: to the commanded poses, or in a dry run lifted. Precondition and
/// errors as below.
MotionProgram MakeRunProgram(const PlanResult& plan, const JobSettings& job, const MotionOptions& options);

/// Makes them with the job's options and the cell's settings for `controller`; `window` is printed in the
/// header; `calls` are those of PlanCallTransitions(). Precondition: WhyNotProgrammable() is empty. Throws
/// InputError when a dry run's lifted points are out of reach.
ProgramMotions MakeProgramMotions(const PlanResult& plan, const JobInputs& inputs,
                                  const std::string& controller, const std::optional<BaseWindow>& window,
                                  const std::vector<CallTransition>& calls = {});

}  // namespace millpose
