// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "tests/program/station_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {

/// The text of a program with external axes, which a test changes, read back and verified.
struct WrittenStations {
  /// `variant`, `coupled`: as of StationPost.
  WrittenStations(const std::string& variant, PlanResult given, bool coupled)
      : plan(std::move(given)), post(variant, plan, coupled) {
    program = MakeMotionProgram(plan, SampleFeeds());
    program.frames_checked = ControllerOf(variant) == "krl";
    files = post.Write(program, plan.arm);
    name = files.rbegin()->first;
    text = files.rbegin()->second;
  }

  /// Throws InputError.
  MotionProgram Read(const std::string& edited) const {
    ProgramFiles other = files;
    other[name] = edited;
    return post.post->Read(other, plan.arm, post.settings);
  }
  std::vector<Finding> Findings(const std::string& edited, bool with_plan = true) const {
    VerifyOptions options = SampleOptions(plan);
    options.interference = interference;
    return Verify(Read(edited), World(cell), with_plan ? &program : nullptr, options, {.threads = 2});
  }

  PlanResult plan;
  StationPost post;
  MotionProgram program;
  ProgramFiles files;
  std::string name, text;
  Cell cell = SampleCell(plan);
  bool interference = true;
};

}  // namespace millpose
