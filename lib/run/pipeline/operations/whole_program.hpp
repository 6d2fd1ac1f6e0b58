// SPDX-License-Identifier: GPL-3.0-or-later
// The main programs of a job with several operations: one for each controller and setup.
#pragma once

#include <functional>
#include <set>

#include "program/verify/verify.hpp"
#include "run/pipeline/operations/done_operation.hpp"

namespace millpose {

/// What one main program calls.
struct MainProgram {
  std::string name;   ///< of the job; where it has setups, of the job and the setup
  std::string setup;  ///< empty: the job has none
  std::vector<DoneOperation> operations;
};

/// One for all operations of a job, or one for each of its setups, in their order.
std::vector<MainProgram> MainProgramsOf(const std::string& job, const std::vector<DoneOperation>& operations);

/// The names of a main program's files, with those of what it calls. Precondition: all operations have a
/// program of the controller.
std::set<std::string> FilesOfMain(const MainProgram& main, const std::string& controller);

/// One controller's: it calls the operations' programs, whose files are among its own.
struct WholeProgram {
  std::string controller;
  std::string name, setup;        ///< as MainProgram has them
  size_t calls = 0;               ///< operations
  ProgramFiles files;             ///< by name; empty where it is withheld
  std::vector<Finding> findings;  ///< empty: confirmed
  std::string withheld;           ///< why there is none; else empty
};

/// Writes the main program and reads it back. It is withheld where an operation has none.
WholeProgram MakeWholeProgram(const MainProgram& main, const std::string& controller);

/// What matters of an operation's files that a main program calls and that are not as the operation's folder
/// has them.
using HoldCalled = std::function<std::vector<Finding>(const DoneOperation&, const ProgramFiles& called)>;

/// What of `files` is not the main program `main` with the operations' own programs, each as its folder has
/// it, or, where it was edited, as `hold` says (without it: any difference), with no file more.
std::vector<Finding> CheckWholeProgram(const MainProgram& main, const std::string& controller,
                                       const ProgramFiles& files, const HoldCalled& hold = nullptr);

}  // namespace millpose
