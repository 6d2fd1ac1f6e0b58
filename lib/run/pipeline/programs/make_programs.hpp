// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "planning/result/cycle_time.hpp"
#include "planning/result/plan_result.hpp"
#include "program/verify/corner_bound.hpp"
#include "program/verify/under_load.hpp"
#include "report/report.hpp"
#include "run/pipeline/programs/programming.hpp"

namespace millpose {

/// One controller's program and what its read-back said.
struct CheckedProgram {
  std::string controller;
  ProgramFiles files;               ///< by name
  std::vector<Finding> findings;    ///< empty: confirmed
  std::vector<int> pass_of_motion;  ///< −1 for motions of gaps
  int saved = 0;                    ///< points left out, see Economise()
  int near = 0;                     ///< points that remain nearer than the least spacing
  std::optional<PathSpeed> speed;   ///< estimated
  std::vector<std::string> warnings;
  ProgramTime time;
  std::optional<UnderLoad> under_load;  ///< of a compensated plan's
  std::string trajectory;               ///< as CSV, where asked for
  std::optional<CornerBound> but_for;   ///< for which alone it is confirmed

  bool Confirmed() const { return findings.empty(); }
  /// Why it is not written, in one sentence; empty when it is confirmed.
  std::string WhyWithheld() const;
};

/// The programs of a job. Each stands by itself: one that is not confirmed withholds no other.
struct JobPrograms {
  std::vector<CheckedProgram> programs;
  std::optional<BaseWindow> base_window;  ///< of all of them, see FindBaseWindow()
};

/// Fills in the frames that a program leaves to the controller (numbered ones) from the plan.
void CompleteFrames(MotionProgram& program, const MotionProgram& planned);

/// Names in the head of a program the hash of the inputs that it is made from.
void NameInputs(const std::string& hash, MotionProgram& program);

/// Names in the heads of written programs `hash` where they name `earlier`, which is as long. A line of the
/// head that no reader makes anything of: what was verified stays so.
void NameInputs(const std::string& earlier, const std::string& hash, ProgramFiles& files);

/// Says in the head of a program what the maker does not document and how far that reaches; returns it.
std::optional<CornerBound> StateCornerBound(const Cell& cell, MotionProgram& program);

/// Writes the program, reads it back and replays it.
/// `not_machined`: holes of the tool path that are left out, named in the head, as the window is
/// (FindBaseWindow); with JobInputs::trajectory also where the arm is at these steps. Precondition:
/// WhyNotProgrammable() is empty.
CheckedProgram MakeProgram(const PlanResult& plan, const std::vector<std::string>& not_machined,
                           const std::optional<BaseWindow>& window, const Programming& with);

}  // namespace millpose
