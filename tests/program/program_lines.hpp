// SPDX-License-Identifier: GPL-3.0-or-later
// The sample's main program of a controller as lines that a test changes, with what it takes to read it
// again.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {

struct ProgramLines {
  /// `name`: see SampleSettings().
  explicit ProgramLines(const std::string& name, PlanResult sample = SamplePlan());

  /// Index of the nth line that matches; a failure where there is none.
  size_t Find(const std::string& pattern, int nth = 0) const;
  void Insert(size_t i, const std::string& line) { lines.insert(lines.begin() + static_cast<long>(i), line); }

  /// Throws InputError.
  MotionProgram Read() const;
  /// What the reader has against the lines.
  std::vector<Problem> Problems() const;

  std::string variant;
  PostSettings settings;
  PlanResult plan;
  MotionProgram program;  ///< that was written
  std::unique_ptr<Post> post;
  ProgramFiles files;  ///< as written
  std::vector<std::string> lines;
};

}  // namespace millpose
