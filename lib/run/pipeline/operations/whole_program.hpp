// SPDX-License-Identifier: GPL-3.0-or-later
// The main program of a job with several operations.
#pragma once

#include <functional>

#include "program/verify/verify.hpp"
#include "run/pipeline/operations/done_operation.hpp"

namespace millpose {

/// One controller's: it calls the operations' programs, whose files are among its own.
struct WholeProgram {
  std::string controller;
  ProgramFiles files;             ///< by name; empty where it is withheld
  std::vector<Finding> findings;  ///< empty: confirmed
  std::string withheld;           ///< why there is none; else empty
};

/// Writes the main program and reads it back. It is withheld where an operation has none.
WholeProgram MakeWholeProgram(const std::string& job, const std::string& controller,
                              const std::vector<DoneOperation>& operations);

/// What matters of an operation's files that a main program calls and that are not as the operation's folder
/// has them.
using HoldCalled = std::function<std::vector<Finding>(const DoneOperation&, const ProgramFiles& called)>;

/// What of `files` is not the main program of `job` with the operations' own programs, each as its folder has
/// it, or, where it was edited, as `hold` says (without it: any difference), with no file more.
std::vector<Finding> CheckWholeProgram(const std::string& job, const std::string& controller,
                                       const std::vector<DoneOperation>& operations,
                                       const ProgramFiles& files, const HoldCalled& hold = nullptr);

}  // namespace millpose
