// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/step_bound.hpp"

#include <gtest/gtest.h>

#include "machine/motion/line.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

MillingPoint At(double x, double feed) {
  MillingPoint point;
  point.position.x() = x;
  point.feed_rate = feed;
  return point;
}

Arm FastArm() {
  Arm arm;
  arm.speed = (Joints() << 1, 2, 1, 1, 1, 1).finished();
  return arm;
}

TEST(StepBound, GrowsWithTheWay) {
  const StepBounds bounds{0.02, 1e9};
  for (const double way : {0.5, 4.0, 20.0})
    EXPECT_NEAR(StepBound(bounds, FastArm(), At(0, 10), At(way, 10))[2], 0.02 * way, 1e-15);
}

TEST(StepBound, IsTheShareOfTheSpeedAtTheFasterFeed) {
  const Joints step = StepBound({1, 0.25}, FastArm(), At(0, 20), At(10, 40));
  EXPECT_NEAR(step[0], 0.25 * 1 * 10 / 40, 1e-15);
  EXPECT_NEAR(step[1], 0.25 * 2 * 10 / 40, 1e-15);
}

TEST(StepBound, IsHalfATurnAtMostAndWhatTheJobAllows) {
  EXPECT_EQ(StepBound({1, 1e9}, FastArm(), At(0, 1), At(1000, 1))[0], kPi);
  EXPECT_EQ(StepBound({1, 1e9, Joints::Constant(0.1)}, FastArm(), At(0, 1), At(1000, 1))[0], 0.1);
}

TEST(StepBound, OfAToolThatTurnsOnTheSpotGoesByItsLever) {
  MillingPoint turned = At(0, 10);
  turned.tool_axis = Eigen::Vector3d(0.1, 0, std::sqrt(0.99));
  EXPECT_NEAR(ToolWay(At(0, 10), turned), kLever * 0.1, 0.1);
  EXPECT_GT(StepBound({0.02, 1e9}, FastArm(), At(0, 10), turned)[0], 0.5);
}

// Points 40 mm apart, so that large steps are allowed: what bends too far is not among them.
TEST(StepLimits, NoMotionBendsFurtherThanItMay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  PathOptions options = Options();
  options.steps = {DegToRad(2), 1e9};
  const Pass pass = Row(-400, 400, 21);
  const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  double largest_step = 0;
  for (const auto& [most, loss] : {std::pair(0.5, 0.0), std::pair(0.5, 0.01), std::pair(0.2, 0.01)}) {
    options.max_deviation = most;
    options.smoothing_loss = loss;
    const PassResult result = PlanPass(problem, world, {pass}, options, {.threads = 1});
    ExpectSound(problem, options, pass, result);
    for (const Segment& piece : result.pieces)
      for (int t = piece.first + 1; t <= piece.last; ++t) {
        const Joints &from = result.points[t - 1].q, &to = result.points[t].q;
        EXPECT_LE(HalfwayDeviation(carrier, from, to).position, most) << t;
        largest_step = std::max(largest_step, (to - from).cwiseAbs().maxCoeff());
      }
  }
  EXPECT_GT(largest_step, DegToRad(1));
}

/// How far the motions of a plan go beyond a bound that they all exceed: mm above a quarter more than with
/// the rotation unchanged, where the arm has that pose.
double LargestExcess(const PoseProblem& problem, const Pass& pass, const PassResult& result, double bound,
                     int* beyond) {
  const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  double excess = 0;
  for (const Segment& piece : result.pieces)
    for (int t = piece.first + 1; t <= piece.last; ++t) {
      const auto &from = result.points[t - 1], &to = result.points[t];
      const double bend = HalfwayDeviation(carrier, from.q, to.q).position;
      if (bend <= bound) continue;
      ++*beyond;
      const PointScorer scorer(problem, pass.points[t], pass.rotation_reference);
      const std::optional<Joints> beside =
          InverseNear(problem.arm, carrier.FlangePose(scorer.ToolPose(from.freedoms)),
                      Status(problem.arm, from.q), from.q);
      if (!beside) continue;
      excess = std::max(excess,
                        bend - std::max(bound, 1.25 * HalfwayDeviation(carrier, from.q, *beside).position));
    }
  return excess;
}

// Points 20 mm apart cannot keep 2 µm. Where a limit of an axis bars a point's rotation at the next, the
// nearest that is not barred is no excuse: there is another way. Nor is the pass cut where there is one.
TEST(StepLimits, WhatBendsFurtherThanAskedForIsAvoidedWhereItCanBe) {
  struct Case {
    int joint;
    double lower, upper;  // deg
    size_t pieces;
  };
  for (const Case& limits : {Case{4, -30, 50, 2}, Case{5, -90, -50, 1}, Case{3, -60, -20, 1}})
    for (const double loss : {0.0, 0.01}) {
      PoseProblem problem = MakeProblem(Kr500R2830());
      problem.bounds.lower[limits.joint] = DegToRad(limits.lower);
      problem.bounds.upper[limits.joint] = DegToRad(limits.upper);
      const World world(EmptyCell(problem));
      PathOptions options = Options();
      options.steps = {DegToRad(2), 1e9};
      options.max_deviation = 0.002;
      options.smoothing_loss = loss;
      const Pass pass = Row(-400, 400, 41);
      const PassResult result = PlanPass(problem, world, {pass}, options, {.threads = 1});
      ExpectSound(problem, options, pass, result);
      int beyond = 0;
      EXPECT_LE(LargestExcess(problem, pass, result, options.max_deviation, &beyond), 1e-9) << limits.joint;
      EXPECT_GT(beyond, 10);
      EXPECT_EQ(result.pieces.size(), limits.pieces) << limits.joint;
    }
}

}  // namespace
}  // namespace millpose
