// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/economy.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/program/left_out.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

TEST(Economy, LeavesOutWhatTheMotionPasses) {
  const MotionProgram program = MakeMotionProgram(SamplePlan({.points = 60, .spacing = 0.5}));
  const EconomyOptions options;
  const EconomyResult result = Economise(program, options);
  ASSERT_TRUE(IsWellFormed(result.program));
  EXPECT_GT(result.saved, 60);
  EXPECT_EQ(result.program.motions.size() + static_cast<size_t>(result.saved), program.motions.size());
  EXPECT_EQ(result.program.events.size(), program.events.size());
  const LeftOut left = MeasureLeftOut(program, result.program);
  EXPECT_EQ(left.count, result.saved);
  EXPECT_LE(left.position, options.position_tolerance);
  EXPECT_LE(left.angle, options.angle_tolerance);
}

/// Points on a curve that bends and turns all the way: what is left out costs nearly as much as it may, and
/// never more.
TEST(Economy, NeverLeavesMoreThanItsTolerances) {
  MotionProgram program = MakeMotionProgram(SamplePlan({.points = 400, .spacing = 0.25, .ring = false}));
  for (const auto& [bend, turn] : {std::pair{2e-4, 0.0}, std::pair{1e-6, 3e-4}, std::pair{1e-4, 1e-4}}) {
    MotionProgram curved = program;
    for (Motion& motion : curved.motions) {
      const double s = motion.point * 0.25;
      if (motion.point < 0) continue;
      motion.X_PT.translation().z() += bend * s * s + 0.3 * std::sin(s / 20);
      motion.X_PT.linear() *=
          Eigen::AngleAxisd(turn * s * s, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
    }
    const EconomyOptions options;
    const EconomyResult result = Economise(curved, options);
    const LeftOut left = MeasureLeftOut(curved, result.program);
    EXPECT_GT(left.count, 400) << bend;
    EXPECT_LE(left.position, options.position_tolerance) << bend;
    EXPECT_LE(left.angle, options.angle_tolerance) << bend;
    EXPECT_GT(std::max(left.position / options.position_tolerance, left.angle / options.angle_tolerance), 0.8)
        << bend;
  }
}

TEST(Economy, KeepsFeedChangesAndEverythingWithoutTolerance) {
  MotionProgram program = MakeMotionProgram(SamplePlan({.points = 30, .spacing = 0.5, .ring = false}));
  EXPECT_EQ(Economise(program, {0, 0, 0}).saved, 0);
  const int all = Economise(program, {}).saved;
  for (size_t i = 10; i < program.motions.size(); i += 2) program.motions[i].feed *= 0.9;
  EXPECT_LT(Economise(program, {}).saved, all);
}

TEST(Economy, KeepsWhereAnOutputIsSwitched) {
  MotionProgram program = MakeMotionProgram(SamplePlan({.points = 30, .spacing = 0.5, .ring = false}));
  const size_t middle = 20;
  ASSERT_EQ(program.motions[middle - 1].pass, 0);
  const auto after = std::find_if(program.events.begin(), program.events.end(),
                                  [&](const ProgramEvent& event) { return event.before_motion > middle; });
  program.events.insert(after, {ProgramEvent::Kind::kOutput, middle, 0, 0, {3, true, 0, true}, 0, 0});
  const EconomyResult result = Economise(program, {});
  ASSERT_TRUE(IsWellFormed(result.program));
  const ProgramEvent* output = nullptr;
  for (const ProgramEvent& event : result.program.events)
    if (event.kind == ProgramEvent::Kind::kOutput) output = &event;
  ASSERT_NE(output, nullptr);
  EXPECT_EQ(result.program.motions[output->before_motion - 1].X_PT.matrix(),
            program.motions[middle - 1].X_PT.matrix());
}

TEST(Economy, MovesPointsApart) {
  // With wide tolerances a motion stands for 512 points, which leaves a short rest of the 600.
  const MotionProgram program =
      MakeMotionProgram(SamplePlan({.points = 600, .spacing = 0.5, .ring = false, .passes = 1}));
  const auto shortest = [&](double spacing) {
    const std::vector<Motion> motions = Economise(program, {1, 0.1, spacing}).program.motions;
    double least = 1e9;
    for (size_t i = 1; i < motions.size(); ++i) {
      if (motions[i].point < 0 || motions[i - 1].point < 0) continue;
      least = std::min(least, (motions[i].X_PT.translation() - motions[i - 1].X_PT.translation()).norm());
    }
    return least;
  };
  EXPECT_LT(shortest(0), 50);
  EXPECT_GE(shortest(100), 100);
}

TEST(Economy, CountsPointsThatStarveTheLookAhead) {
  const MotionProgram program = MakeMotionProgram(SamplePlan({.points = 30, .spacing = 0.5}));
  EXPECT_EQ(Economise(program, {0, 0, 0}).near, 0);
  EXPECT_EQ(Economise(program, {0, 0, 0.6}).near,
            2 * 29);  // the straight passes; the ring's points are 2 mm apart
}

TEST(DryRun, LiftsEveryCutAlongTheToolAndNeverGoesDeeper) {
  const PlanResult plan = SamplePlan({.wall_turn_deg = -75, .tilt_deg = 7});
  MotionOptions options;
  options.approach_feed = 15;
  options.approach_slow = 5;
  const MotionProgram program = MakeMotionProgram(plan, options),
                      lifted = MakeMotionProgram(Lifted(plan, 20), options);
  ASSERT_EQ(program.motions.size(), lifted.motions.size());
  for (size_t i = 0; i < program.motions.size(); ++i) {
    const Motion& motion = program.motions[i];
    const Eigen::Vector3d off =
        motion.X_PT.linear().transpose() * (lifted.motions[i].X_PT.translation() - motion.X_PT.translation());
    // The approach slows down before the lifted point, not before the one in the material.
    const bool approach = motion.type == MotionType::kLinear && motion.point < 0 &&
                          program.motions[i + 1].type == MotionType::kLinear;
    EXPECT_LT((off - Eigen::Vector3d(0, 0, motion.point >= 0 || approach ? 20 : 0)).norm(), 1e-6) << i;
    const Pose reached = program.X_BP->inverse() * ForwardFlange(plan.arm, *lifted.motions[i].q) * plan.X_FT;
    EXPECT_LT((reached.translation() - lifted.motions[i].X_PT.translation()).norm(), 1e-6);
  }
  EXPECT_THROW(Lifted(plan, 5000), InputError);
}

}  // namespace
}  // namespace millpose
