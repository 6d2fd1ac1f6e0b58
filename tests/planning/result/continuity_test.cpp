// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/continuity.hpp"

#include "machine/motion/line.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

/// A cut of 200 mm in steps of 1 mm at `feed` (mm/s), A6 swinging by ±0.5 rad, in two pieces.
PlanResult SwingingPlan(double feed) {
  PlanResult plan;
  const Cell cell = EmptyCell();
  plan.arm = cell.arm;
  plan.X_FT = cell.X_FT;
  PassResult empty;
  empty.points.resize(7);
  PassResult pass;
  pass.pass = 1;
  for (int i = 0; i <= 200; ++i) {
    PlannedPoint point;
    point.q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
    point.q[5] += 0.5 * std::sin(i / 20.0);
    point.point.arc_length = i;
    point.point.feed_rate = feed;
    point.point.position.x() = i;
    pass.points.push_back(point);
  }
  pass.pieces = {{1, 0, 0, 99, false}, {1, 1, 100, 200, false}};
  plan.passes = {empty, pass};
  return plan;
}

TEST(Continuity, SlowCutsAreHeld) {
  const ContinuityFigures figures = AnalyseContinuity(SwingingPlan(2));
  EXPECT_TRUE(figures.feed_not_held.empty());
  EXPECT_NEAR(figures.speed_share[5], 0.5 / 20 * 2 / SampleArm().speed[5], 1e-3);
  EXPECT_NEAR(figures.acceleration_share[5], 0.5 / 400 * 4 / SampleArm().acceleration[5], 1e-4);
  EXPECT_NEAR(figures.acceleration_rms[5], 0.5 / 400 * 4 / std::sqrt(2), 2e-4);
  EXPECT_EQ(figures.speed_share[0], 0);
  EXPECT_NEAR(figures.wrist, std::sin(DegToRad(53.1)), 1e-12);
  EXPECT_GT(figures.elbow, 0.1);
  EXPECT_GT(figures.shoulder, 500);
  EXPECT_GT(figures.halfway_deviation, 0);
}

TEST(Continuity, FastCutsNameThePointsInTheJobAndReducingRepairsThem) {
  PlanResult plan = SwingingPlan(120);
  const ContinuityFigures before = AnalyseContinuity(plan);
  ASSERT_FALSE(before.feed_not_held.empty());
  const FeedFinding& first = before.feed_not_held.front();
  EXPECT_EQ(first.pass, 1);
  EXPECT_EQ(first.point, 7u);  // after the seven of pass 0
  EXPECT_EQ(first.joint, 5);
  EXPECT_EQ(first.feed, 120);
  EXPECT_NEAR(first.feed_possible, SampleArm().speed[5] * 40, 1);
  const FeedReduction reduction = ReduceFeeds(plan);
  EXPECT_GE(reduction.points, before.feed_not_held.size());
  EXPECT_LT(reduction.least, 120);
  const ContinuityFigures after = AnalyseContinuity(plan);
  EXPECT_TRUE(after.feed_not_held.empty());
  EXPECT_LE(after.speed_share.maxCoeff(), 1 + 1e-9);
  EXPECT_EQ(ReduceFeeds(plan).points, 0u);
}

TEST(Continuity, ReducedFeedsHoldInTheReplayOfStraightMotions) {
  PlanResult plan = SwingingPlan(120);
  ReduceFeeds(plan);
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT};
  const Joints any = Joints::Constant(100);
  double most = 0;
  for (const Segment& piece : plan.passes[1].pieces)
    for (int i = piece.first + 1; i <= piece.last; ++i) {
      const PlannedPoint &from = plan.passes[1].points[i - 1], &to = plan.passes[1].points[i];
      const LineMotion line =
          FollowLine(carrier, from.q, carrier.ToolPose(to.q), -any, any, {0.05, 0.0005, 10});
      ASSERT_EQ(line.problem, "");
      const double way = (to.point.arc_length - from.point.arc_length) / (line.joints.size() - 1.0);
      for (size_t k = 1; k < line.joints.size(); ++k) {
        const Joints speed = (line.joints[k] - line.joints[k - 1]).cwiseAbs() / (way / to.point.feed_rate);
        most = std::max(most, speed.cwiseQuotient(plan.arm.speed).maxCoeff());
      }
    }
  EXPECT_LE(most, 1);
  EXPECT_GT(most, 0.9);  // and are no lower than need be
}

/// The arm held still on a rail that runs with the tip, at `feed` mm/s, and for the middle third twice as
/// far.
PlanResult RailPlan(double feed) {
  PlanResult plan = SwingingPlan(feed);
  plan.external_axes = {{.name = "rail",
                         .direction = Eigen::Vector3d::UnitX(),
                         .lower = -1000,
                         .upper = 1000,
                         .speed = 30,
                         .acceleration = 200,
                         .compliance = {}}};
  for (PassResult& pass : plan.passes) pass.external = {0};
  double rail = 0;
  for (PlannedPoint& point : plan.passes[1].points) {
    point.q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
    point.external = ExternalPosition{rail};
    rail += point.point.arc_length >= 70 && point.point.arc_length < 140 ? 2 : 1;
  }
  return plan;
}

TEST(Continuity, ReducedFeedsHoldTheSpeedsOfExternalAxes) {
  EXPECT_TRUE(AnalyseContinuity(RailPlan(5)).feed_not_held.empty());
  PlanResult plan = RailPlan(25);
  const ContinuityFigures figures = AnalyseContinuity(plan);
  ASSERT_FALSE(figures.feed_not_held.empty());
  for (const FeedFinding& finding : figures.feed_not_held) EXPECT_EQ(finding.joint, 6);
  EXPECT_EQ(AxisName(plan.external_axes, 6), "rail");
  EXPECT_EQ(AxisName(plan.external_axes, 2), "A3");
  EXPECT_LT(AnalyseContinuity(RailPlan(10)).halfway_deviation, 1e-9);  // straight on the part
  ReduceFeeds(plan);
  double most = 0;
  for (const Segment& piece : plan.passes[1].pieces)
    for (int i = piece.first + 1; i <= piece.last; ++i) {
      const PlannedPoint &from = plan.passes[1].points[i - 1], &to = plan.passes[1].points[i];
      const double seconds = (to.point.arc_length - from.point.arc_length) / to.point.feed_rate;
      most = std::max(most, std::abs((*to.external)[0] - (*from.external)[0]) / seconds);
    }
  EXPECT_LE(most, 0.99 * 30 * (1 + 1e-9));
  EXPECT_GT(most, 0.98 * 30);
  EXPECT_TRUE(AnalyseContinuity(plan).feed_not_held.empty());
}

TEST(Continuity, TellsWhereReducedFeedsFallFarAndWhichJointIsToBlame) {
  PlanResult plan = SwingingPlan(120);
  const FeedReduction reduction = ReduceFeeds(plan);
  ASSERT_FALSE(reduction.slow.empty());
  for (const SlowStretch& s : reduction.slow) {
    EXPECT_EQ(s.pass, 1);
    EXPECT_EQ(s.joint, 5);
    EXPECT_EQ(s.wanted, 120);
    EXPECT_LT(s.Share(), kSlowShare);
    double least = 120;
    for (size_t point = s.first; point <= s.last; ++point) {
      const double feed = plan.passes[1].points[point - 7].point.feed_rate;  // after the seven of pass 0
      EXPECT_LT(feed, kSlowShare * 120);
      least = std::min(least, feed);
    }
    EXPECT_EQ(s.feed, least);
  }
  PlanResult slow = SwingingPlan(2);
  EXPECT_TRUE(ReduceFeeds(slow).slow.empty());
}

TEST(Continuity, AClosedPieceIncludesItsWayBackToTheStart) {
  PlanResult plan = SwingingPlan(2);
  PassResult& pass = plan.passes[1];
  pass.pieces = {{1, 0, 0, 200, true}};
  for (int i = 0; i <= 200; ++i) {
    PlannedPoint& point = pass.points[i];
    point.q[5] = 2 * kPi * i / 201;  // once round, closing modulo a full revolution
    point.point.position =
        Eigen::Vector3d(std::cos(point.q[5]), std::sin(point.q[5]), 0) / (2 * std::sin(kPi / 201));
  }
  const ContinuityFigures figures = AnalyseContinuity(plan);
  EXPECT_NEAR(figures.speed_share[5], 2 * kPi / 201 * 2 / SampleArm().speed[5], 1e-9);
  EXPECT_LT(figures.acceleration_share[5], 1e-9);
}

}  // namespace
}  // namespace millpose::test
