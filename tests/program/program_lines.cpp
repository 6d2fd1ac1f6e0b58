// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/program_lines.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "program/scanner.hpp"

namespace millpose {

ProgramLines::ProgramLines(const std::string& name, PlanResult sample)
    : variant(name),
      settings(SampleSettings(name)),
      plan(std::move(sample)),
      program(MakeMotionProgram(plan)),
      post(SamplePost(name)),
      files(post->Write(program, plan.arm, settings)) {
  for (const std::string_view line : SplitLines(files.rbegin()->second)) lines.emplace_back(line);
}

size_t ProgramLines::Find(const std::string& pattern, int nth) const {
  const std::regex regex(pattern);
  for (size_t i = 0; i < lines.size(); ++i) {
    if (std::regex_search(lines[i], regex) && nth-- == 0) return i;
  }
  ADD_FAILURE() << "no line " << pattern;
  return 0;
}

MotionProgram ProgramLines::Read() const {
  ProgramFiles changed = files;
  std::string& text = changed.rbegin()->second;  // .src comes after .dat
  text.clear();
  for (const std::string& line : lines) text += line + "\n";
  return post->Read(changed, plan.arm, settings);
}

std::vector<Problem> ProgramLines::Problems() const {
  try {
    Read();
    return {};
  } catch (const InputError& error) {
    return error.problems();
  }
}

}  // namespace millpose
