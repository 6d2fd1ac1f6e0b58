// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/under_load.hpp"

#include <gtest/gtest.h>

#include "machine/robot/kinematics.hpp"
#include "tests/planning/compensation/forced_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

PlanResult Compensated() {
  PlanResult plan = Forced();
  Compensate(Sure(), ForcesOf(plan), plan);
  return plan;
}

double LargestNormalShift(const PlanResult& plan) {
  double largest = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      largest = std::max(largest, std::abs(point.compensation->normal.taken));
  return largest;
}

TEST(UnderLoad, AProgramOfTheCommandedPosesCarriesTheShiftsAndOneOfTheNominalDoesNot) {
  const PlanResult plan = Compensated();
  const Cell cell = SampleCell(plan);
  EXPECT_LT(ReplayUnderLoad(MakeMotionProgram(Commanded(plan)), cell, plan).largest, 1e-7);
  const UnderLoad missed = ReplayUnderLoad(MakeMotionProgram(plan), cell, plan);
  EXPECT_NEAR(missed.largest, LargestNormalShift(plan), 1e-4);
  std::vector<Finding> findings;
  CheckUnderLoad({5e-4, 0, 3}, 1e-3, findings);
  EXPECT_TRUE(findings.empty());
  CheckUnderLoad(missed, 1e-3, findings);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].cause, Cause::kPath);
}

// The path's tolerance alone lets such a program pass.
TEST(UnderLoad, AShiftBelowTheTolerancesIsMissedByNothingElse) {
  PlanResult plan = Forced(100);
  Compensate(Sure(), ForcesOf(plan), plan);
  ASSERT_GT(LargestNormalShift(plan), 0.003);
  ASSERT_LT(LargestNormalShift(plan), 0.02);
  const Cell cell = SampleCell(plan);
  const MotionProgram commanded = MakeMotionProgram(Commanded(plan)), nominal = MakeMotionProgram(plan);
  EXPECT_TRUE(Verify(nominal, World(cell), &commanded, SampleOptions(plan), {.threads = 1}).empty());
  EXPECT_GT(ReplayUnderLoad(nominal, cell, plan).largest, 0.003);
}

/// On its way to a first point that is too deep the tool passes the right one, and again on its way up.
TEST(UnderLoad, EndsOfCutsAreHeldLikeInnerPoints) {
  const PlanResult plan = Compensated();
  const Cell cell = SampleCell(plan);
  constexpr double kDeeper = 0.0136;  // mm: within the path's tolerance
  const MotionProgram commanded = MakeMotionProgram(Commanded(plan));
  for (const PassResult& pass : plan.passes) {
    for (const int point : {pass.pieces[0].first, pass.pieces[0].last}) {
      MotionProgram program = commanded;
      const auto at = std::ranges::find_if(program.motions, [&](const Motion& motion) {
        return motion.pass == pass.pass && motion.point == point;
      });
      ASSERT_NE(at, program.motions.end());
      const Pose X_BF = ForwardFlange(plan.arm, *at->q) * plan.X_FT * Eigen::Translation3d(0, 0, -kDeeper) *
                        plan.X_FT.inverse();
      at->q = InverseNear(plan.arm, X_BF, Status(plan.arm, *at->q), *at->q);
      at->X_PT = at->X_PT * Eigen::Translation3d(0, 0, -kDeeper);
      EXPECT_TRUE(Verify(program, World(cell), &commanded, SampleOptions(plan), {.threads = 1}).empty());
      EXPECT_GT(ReplayUnderLoad(program, cell, plan).largest, 0.01) << pass.pass << " " << point;
    }
  }
}

class Notice : public testing::TestWithParam<std::string> {};

TEST_P(Notice, IsWrittenReadBackAndMissed) {
  const PlanResult plan = Compensated();
  const PostSettings settings = SampleSettings(GetParam());
  const auto post = SamplePost(GetParam());
  MotionOptions options;
  options.notice = kCompensatedNotice;
  const MotionProgram program =
      Prepared(MakeMotionProgram(Commanded(plan), options), GetParam(), settings, plan.arm);
  ProgramFiles files = post->Write(program, plan.arm, settings);
  EXPECT_EQ(post->Read(files, plan.arm, settings).notice, kCompensatedNotice);
  // Without it, and with another text in its place.
  size_t changed = 0;
  for (auto& [name, text] : files) {
    const size_t at = text.find(kCompensatedNotice);
    if (at == std::string::npos || text.find(";") == std::string::npos) continue;
    text.replace(at, 11, "FOR THE CUT");
    ++changed;
  }
  ASSERT_EQ(changed, 1u);
  try {
    const MotionProgram back = post->Read(files, plan.arm, settings);
    EXPECT_EQ(back.notice, "");
    MotionProgram wanted = program;
    const std::vector<Finding> findings =
        Verify(back, World(SampleCell(plan)), &wanted, SampleOptions(plan), {.threads = 1});
    EXPECT_TRUE(std::ranges::any_of(findings, [](const Finding& finding) {
      return finding.message.find("notice") != std::string::npos;
    }));
  } catch (const InputError&) {
    EXPECT_EQ(GetParam(), "krl");  // whose message is a block that must be the writer's own
  }
}

INSTANTIATE_TEST_SUITE_P(All, Notice, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& variant) { return variant.param; });

}  // namespace
}  // namespace millpose
