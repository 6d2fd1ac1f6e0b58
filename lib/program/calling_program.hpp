// SPDX-License-Identifier: GPL-3.0-or-later
// A main program that calls others, one after the other, and does nothing else.
#pragma once

#include "program/post.hpp"

namespace millpose {

/// A program that another one calls: the files of one that stands by itself, changed as little as that takes.
struct CalledProgram {
  std::string name;                                                ///< by which it is called
  ProgramFiles files;                                              ///< by name
  std::vector<std::pair<std::string, std::string>> comments = {};  ///< key, value: before its call
};

/// The name of the main file of a program, without its ending.
std::string ProgramName(const CallingSyntax& syntax, const std::string& job);

/// The program of `job` as one that is called. Precondition: `files` are what the controller's post wrote for
/// it.
CalledProgram AsCalled(const CallingSyntax& syntax, const std::string& job, ProgramFiles files);

/// The files of the main program of `job`, which calls `programs` in their order; their own files are not
/// among them.
ProgramFiles WriteCalling(const CallingSyntax& syntax, const std::string& job,
                          const std::vector<std::pair<std::string, std::string>>& header,
                          const std::vector<CalledProgram>& programs);

/// The names of the programs that the main program of `job` calls, in their order. Throws InputError with the
/// line of everything that is neither a comment, nor one of these calls, nor what begins and ends a program.
std::vector<std::string> ReadCalling(const CallingSyntax& syntax, const std::string& job,
                                     const ProgramFiles& files);

/// What a main program that calls others and does nothing else calls; empty where `text`, the file of the
/// name `stem`, is something else.
std::vector<std::string> CallsOf(const CallingSyntax& syntax, const std::string& stem,
                                 const std::string& text);

/// The text of a program that is called as that of one that stands by itself, line for line; as it is where
/// it is none.
std::string AsStandingAlone(const CallingSyntax& syntax, const std::string& name, const std::string& text);

}  // namespace millpose
