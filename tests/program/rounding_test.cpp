// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rounding.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "program/path_speed.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

constexpr PathTolerance kTolerance{0.016, 0.016 * kRadPerDeg};

/// Straight motions through these places, exact at both ends, after a joint motion to the first.
MotionProgram Through(const std::vector<Eigen::Vector3d>& places, double feed = 10) {
  MotionProgram program;
  for (const Eigen::Vector3d& place : places) {
    Motion& motion = program.motions.emplace_back();
    motion.type = program.motions.size() == 1 ? MotionType::kJoint : MotionType::kLinear;
    motion.X_PT.translation() = place;
    motion.feed = feed;
    motion.pass = 0;
    motion.point = static_cast<int>(program.motions.size()) - 1;
  }
  program.motions.front().exact = program.motions.back().exact = true;
  return program;
}

TEST(Rounding, ARightAngleBoundsItselfAlone) {
  MotionProgram program = Through({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {20, 10, 0}, {20, 20, 0}});
  ChooseRounding(program, kTolerance);
  EXPECT_TRUE(program.blend_is_distance);
  EXPECT_NEAR(program.motions[2].blend, 4 * 0.016 / std::sqrt(2), 1e-4);
  // The points on the straight ways to and from it are passed as before: their distance is their own.
  for (const size_t i : {1, 3}) EXPECT_EQ(program.motions[i].blend, 5) << i;
  EXPECT_EQ(program.motions[0].blend, 0);
  EXPECT_EQ(program.motions[4].blend, 0);
}

TEST(Rounding, WhereHalfOfEveryMotionIsWithinToleranceNothingBoundsIt) {
  MotionProgram program = Through({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {50, 0, 0}, {60, 0, 0}});
  ChooseRounding(program, kTolerance);
  EXPECT_EQ(program.motions[1].blend, 5);
}

/// The sample's passes and ring, walked densely: the blend as a parabola stays within the tolerance of the
/// path, and a larger distance would not.
TEST(Rounding, IsAsLargeAsTheToleranceAllowsInEveryPiece) {
  const MotionProgram planned = MakeMotionProgram(SamplePlan());
  MotionProgram program = planned;
  ChooseRounding(program, kTolerance);
  int bounded = 0;
  for (size_t i = 1; i + 1 < program.motions.size(); ++i) {
    const Motion& motion = program.motions[i];
    if (motion.blend == 0) continue;
    const Corner corner =
        CornerBetween(program.motions[i - 1].X_PT, motion.X_PT, program.motions[i + 1].X_PT);
    const double reach = std::min(motion.blend, corner.shorter / 2);
    const Eigen::Vector3d in =
        (motion.X_PT.translation() - program.motions[i - 1].X_PT.translation()).normalized();
    const Eigen::Vector3d out =
        (program.motions[i + 1].X_PT.translation() - motion.X_PT.translation()).normalized();
    for (int k = 0; k <= 500; ++k) {
      const double t = k / 500.0;
      const Eigen::Vector3d p = t * t * reach * out - (1 - t) * (1 - t) * reach * in;
      const double off =
          std::min((p - std::min(0.0, p.dot(in)) * in).norm(), (p - std::max(0.0, p.dot(out)) * out).norm());
      ASSERT_LE(off, kTolerance.position) << i;
    }
    EXPECT_LE(RoundedBy(corner, motion.blend).angle, kTolerance.angle);
    const CornerRounding more = RoundedBy(corner, motion.blend + 2e-4);
    if (more.position > kTolerance.position || more.angle > kTolerance.angle) ++bounded;
  }
  EXPECT_GT(bounded, 0);  // the ring's corners
}

TEST(Rounding, CornersThatDifferByLessThanTwiceShareADistance) {
  // Turns by 30, 40 and 35 degrees, then by 2.
  std::vector<Eigen::Vector3d> places = {{0, 0, 0}, {10, 0, 0}};
  double heading = 0;
  for (const double turn : {30, 40, 35, 2, 0}) {
    heading += turn * kRadPerDeg;
    places.push_back(places.back() + 10 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0));
  }
  MotionProgram program = Through(places);
  ChooseRounding(program, kTolerance);
  const double sharpest = 4 * 0.016 / (2 * std::sin(20 * kRadPerDeg));
  for (const size_t i : {1, 2, 3}) EXPECT_NEAR(program.motions[i].blend, sharpest, 1e-4) << i;
  EXPECT_NEAR(program.motions[4].blend, 4 * 0.016 / (2 * std::sin(1 * kRadPerDeg)), 1e-4);
}

TEST(PathSpeed, NamesTheCornerAndTheShortMotion) {
  MotionProgram program = Through({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {10, 10.06, 0}, {10, 20, 0}});
  ChooseRounding(program, kTolerance);
  const PathDynamics dynamics;
  const SpeedEstimate estimate = EstimateSpeed(program, dynamics);
  // 0.0452 mm of rounding per 12 ms; 0.06 mm of motion per 12 ms, and 0.03 mm of rounding at its ends.
  ASSERT_EQ(estimate.places.size(), 4u);
  EXPECT_EQ(estimate.places[0].motion, 1u);
  EXPECT_FALSE(estimate.places[0].short_motion);
  EXPECT_NEAR(estimate.places[0].speed, program.motions[1].blend / 0.012, 1e-9);
  EXPECT_EQ(estimate.places[2].motion, 3u);
  EXPECT_TRUE(estimate.places[2].short_motion);
  EXPECT_NEAR(estimate.places[2].speed, 5, 1e-6);
  EXPECT_NEAR(estimate.lowest_share, 0.03 / 0.012 / 10, 1e-6);
}

TEST(PathSpeed, AFeedThatIsHeldIsNotSlow) {
  MotionProgram program = Through({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}});
  ChooseRounding(program, kTolerance);
  const SpeedEstimate estimate = EstimateSpeed(program, {});
  EXPECT_EQ(estimate.lowest_share, 1);
  EXPECT_TRUE(estimate.places.empty());
  // A hundredth of a millimetre at 600 mm/min is a tenth of what one cycle needs.
  for (Motion& motion : program.motions) motion.blend = motion.exact ? 0 : 0.012;
  EXPECT_NEAR(EstimateSpeed(program, {}).lowest_share, 0.1, 1e-9);
}

TEST(PathSpeed, ABoundOfTheDeviationIsADistanceToo) {
  MotionProgram program = Through({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}});
  program.motions[1].blend = 0.016;
  const double by_bound = EstimateSpeed(program, {}).lowest_share;
  ChooseRounding(program, kTolerance);
  EXPECT_NEAR(by_bound, EstimateSpeed(program, {}).lowest_share, 1e-3);
}

}  // namespace
}  // namespace millpose
