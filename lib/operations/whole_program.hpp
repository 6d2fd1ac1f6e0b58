// SPDX-License-Identifier: GPL-3.0-or-later
// The main program of a job with several operations.
#pragma once

#include "operations/done_operation.hpp"
#include "verify/verify.hpp"

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

/// What of `files` is not the main program of `job` with the operations' own programs, each as its folder has
/// it.
std::vector<Finding> CheckWholeProgram(const std::string& job, const std::string& controller,
                                       const std::vector<DoneOperation>& operations,
                                       const ProgramFiles& files);

}  // namespace millpose
