// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of an output folder, as what the texts of its programs are held against.
#pragma once

#include <map>
#include <memory>

#include "run/pipeline/programs/program_motions.hpp"
#include "run/pipeline/programs/programming.hpp"
#include "run/pipeline/programs/verify_programs.hpp"
#include "store/manifest.hpp"

namespace millpose {

/// A program of a plan with what it was written from.
struct PlannedProgram {
  PlanResult plan;  ///< of what it mills
  ProgramMotions motions;
};

class PlannedFolder {
 public:
  /// Reads plan, job and cell. Throws InputError. Precondition: they are as `manifest`, the folder's, has
  /// them. `arguments` outlives it.
  PlannedFolder(std::filesystem::path folder, Manifest manifest, const VerifyArguments& arguments,
                Execution execution);

  /// The controllers that the folder holds programs of, in the order of their names.
  std::vector<std::string> Controllers() const;
  /// `program`, a main file with those that it calls, in any folder, against the program of its name among
  /// the plan's: that of a single piece, else the whole one.
  VerifiedProgram Hold(const std::filesystem::path& program) const;
  /// Likewise: these files, whose main one is named `name`, wherever they are (`where`: for people).
  VerifiedProgram Hold(const std::string& controller, const std::string& name, const ProgramFiles& files,
                       const std::string& where) const;
  /// All programs of the folder.
  std::vector<VerifiedProgram> HoldAll() const;

 private:
  Programming With(const std::string& controller) const;
  ProgramFiles FilesIn(const std::filesystem::path& folder) const;
  std::vector<std::string> Changed(const std::string& controller, const ProgramFiles& files) const;
  /// `complete`: with all files that were written.
  VerifiedProgram HoldTo(const PlannedProgram& planned, const ProgramFiles& files, const std::string& where,
                         bool complete, Programming with) const;
  const std::vector<CallTransition>& Calls(const std::string& controller) const;
  PlannedProgram Made(PlanResult plan, const std::string& controller) const;
  /// The plan of a single piece's program, by the name of its main file; empty where none is called so.
  std::optional<PlanResult> StartOf(const std::string& name) const;
  void MissLost(std::vector<VerifiedProgram>& programs) const;
  void HoldStarts(const Programming& with, std::vector<VerifiedProgram>& programs) const;

  const std::filesystem::path folder_;
  const Manifest manifest_;
  const VerifyArguments& arguments_;
  const Execution execution_;
  PlanResult plan_;
  std::optional<PlanResult> ways_;  // of the programs of single pieces, where there are some
  JobInputs inputs_;
  std::unique_ptr<World> world_;
  mutable std::map<std::string, std::vector<CallTransition>>
      calls_;  // by controller, once they are asked for
};

}  // namespace millpose
