// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/step_bound.hpp"

#include <gtest/gtest.h>

#include "motion/line.hpp"
#include "tests/path/pass_problem.hpp"

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
    const PassResult result = PlanPass(problem, world, pass, 0, 0, options, 1, {});
    ExpectSound(problem, options, pass, result);
    for (const Piece& piece : result.pieces)
      for (int t = piece.first + 1; t <= piece.last; ++t) {
        const Joints &from = result.points[t - 1].q, &to = result.points[t].q;
        EXPECT_LE(HalfwayDeviation(carrier, from, to).position, most) << t;
        largest_step = std::max(largest_step, (to - from).cwiseAbs().maxCoeff());
      }
  }
  EXPECT_GT(largest_step, DegToRad(1));
}

}  // namespace
}  // namespace millpose
