// SPDX-License-Identifier: GPL-3.0-or-later
// The real interpreter of LinuxCNC reads what the post writes.
#include <gtest/gtest.h>

#include "tests/program/interpreter.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

void ExpectAccepted(const PlanResult& plan) {
  for (const std::string variant : {"linuxcnc", "linuxcnc_cartesian"}) {
    const PostSettings settings = SampleSettings(variant);
    const auto post = MakePost("linuxcnc");
    MotionOptions options;
    options.outputs = {{2, true, 0, true}, {2, false, 0, false}};
    const ProgramFiles files = post->Write(MakeMotionProgram(plan, options), plan.arm, settings);
    ExpectInterpreted(files.begin()->second, post->Read(files, plan.arm, settings));
  }
}

TEST(Rs274, AcceptsTheSample) { ExpectAccepted(SamplePlan()); }

TEST(Rs274, KeepsTheTimeWhereTheArmBarelyMoves) {
  // 0.02 mm apart at 80 mm/min, but turned by the tool's rotation: joints 1 to 3 are slower than G93's floor.
  PlanResult plan = SamplePlan({.points = 3, .spacing = 0.02, .ring = false});
  for (PassResult& pass : plan.passes) {
    for (PlannedPoint& point : pass.points) point.point.feed_rate = 0.01;
  }
  ExpectAccepted(plan);
}

TEST(Rs274, RefusesWhatIsWrong) { EXPECT_NE(Interpret("G21 G90\nG93\nG1 X1 Y2 Z3\nM2\n").status, 0); }

}  // namespace
}  // namespace millpose
