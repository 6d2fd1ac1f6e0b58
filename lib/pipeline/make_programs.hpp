// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <stop_token>

#include "cell/world.hpp"
#include "pipeline/inputs.hpp"
#include "plan/plan_result.hpp"
#include "report/report.hpp"
#include "verify/verify.hpp"

namespace millpose {

/// One controller's program and what its read-back said.
struct CheckedProgram {
  std::string controller;
  ProgramFiles files;               ///< by name
  std::vector<Finding> findings;    ///< empty: confirmed
  std::vector<int> pass_of_motion;  ///< −1 for motions of gaps
  int saved = 0;                    ///< points left out, see Economise()
  int near = 0;                     ///< points that remain nearer than the least spacing
  std::vector<std::string> warnings;
};

/// The programs of a job.
struct JobPrograms {
  std::vector<CheckedProgram> programs;
  std::optional<BaseWindow> base_window;  ///< of all of them, see FindBaseWindow()

  bool Confirmed() const;  ///< none has findings
};

/// The name of the plan in its output folder, from which programs can be verified again.
inline constexpr const char* kPlanFile = "plan.cbor";

/// Fills in the frames that a program leaves to the controller (numbered ones) from the plan.
void CompleteFrames(MotionProgram& program, const MotionProgram& planned);

/// Writes the program of every controller that the job names, reads it back and replays it. `not_machined`:
/// holes of the tool path that are left out, named in the head.
JobPrograms MakePrograms(const PlanResult& plan, const JobInputs& inputs,
                         const std::vector<std::string>& not_machined, const World& world, int threads,
                         std::stop_token stop);

}  // namespace millpose
