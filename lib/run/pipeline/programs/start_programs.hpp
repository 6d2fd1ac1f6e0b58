// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that start one piece by itself (docs/resume.md).
#pragma once

#include <map>

#include "planning/links/job_planner.hpp"
#include "run/pipeline/programs/programming.hpp"

namespace millpose {

/// A program that cuts one piece alone, from home and back.
struct StartProgram {
  int pass = 0, piece = 0;
  std::string name;               ///< of its main file, without ending
  ProgramFiles files;             ///< by name
  std::vector<Finding> findings;  ///< empty: confirmed
  std::string obstacle;           ///< why there is none: a way that could not be planned; else empty

  bool Confirmed() const { return findings.empty() && obstacle.empty(); }
};

/// All of a job.
struct JobStarts {
  PlanResult ways;  ///< its gaps alone: from home to every piece but the first, in the order of execution
  std::map<std::string, std::vector<StartProgram>> programs;  ///< by controller, in that order
};

/// The folder beside a program's files that holds the programs of its pieces, and the file of JobStarts::ways
/// in the output folder.
inline constexpr const char* kStarts = "starts";
inline constexpr const char* kStartWays = "starts.cbor";

/// The ways by which every piece but the first is reached from home; `gaps` as LinkMoveEnds() returns them.
std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> StartEnds(
    const std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>>& gaps);

/// The plan of a program that cuts one piece alone, `index` in the order of execution, under the program's
/// name: from home by its own way, and home again by the way to the next piece and back along that one's own.
/// A way that could not be planned shows as in any plan (WhyNotProgrammable). `ways` as in JobStarts.
PlanResult SingleStart(const PlanResult& plan, const PlanResult& ways, size_t index);

/// The programs that start each piece, written and read back; none where there is one piece, which the whole
/// program starts. `not_machined` as for MakeProgram(). Precondition: WhyNotProgrammable(plan) is empty.
std::vector<StartProgram> MakeStartPrograms(const PlanResult& plan, const PlanResult& ways,
                                            const std::vector<std::string>& not_machined,
                                            const Programming& with);

}  // namespace millpose
