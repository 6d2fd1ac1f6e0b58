// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/large_steps.hpp"

#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

std::vector<size_t> Marked(const std::vector<char>& steps) {
  std::vector<size_t> marked;
  for (size_t t = 0; t < steps.size(); ++t)
    if (steps[t] != 0) marked.push_back(t);
  return marked;
}

class LargeStepsTest : public testing::Test {
 protected:
  /// Ten points of a row planned in one piece, its joints as they stand at the first point.
  LargeStepsTest() {
    options_.steps.most = Joints::Constant(DegToRad(5));
    const PoseProblem problem = MakeProblem(Kr500R2830());
    carrier_ = {problem.arm, problem.X_WB, problem.X_FT};
    pass_ = Row(-90, 90, 10);
    for (const MillingPoint& point : pass_.points) {
      PlannedPoint& planned = plan_.points.emplace_back();
      planned.point = point;
      planned.q << 0, -1.2, 1.6, 0.3, 0.7, 0;
    }
  }

  std::vector<size_t> Steps() const { return Marked(LargeSteps(carrier_, pass_, plan_, options_)); }

  Carrier carrier_;
  Pass pass_;
  PathOptions options_;
  PassResult plan_;
};

TEST_F(LargeStepsTest, OnesThatUseUpTheBoundPerStepAndOneBeside) {
  EXPECT_EQ(Steps(), (std::vector<size_t>{}));
  for (size_t t = 5; t < 10; ++t) plan_.points[t].q[5] += DegToRad(4.5);
  EXPECT_EQ(Steps(), (std::vector<size_t>{3, 4, 5}));
  for (size_t t = 5; t < 10; ++t) plan_.points[t].q[5] -= DegToRad(1.5);
  EXPECT_EQ(Steps(), (std::vector<size_t>{}));
}

TEST_F(LargeStepsTest, OnesThatBendAsFarAsTheyMay) {
  for (size_t t = 5; t < 10; ++t) plan_.points[t].q[0] += DegToRad(3);
  EXPECT_EQ(Steps(), (std::vector<size_t>{}));
  const PlannedPoint &from = plan_.points[4], &to = plan_.points[5];
  options_.max_deviation = HalfwayDeviation(carrier_, from.q, to.q).position * 1.1;
  ASSERT_GT(options_.max_deviation, 0.1);
  EXPECT_EQ(Steps(), (std::vector<size_t>{3, 4, 5}));
}

TEST_F(LargeStepsTest, OnesAtPointsThatNoStepJoinsAndWhereThePassIsSplit) {
  plan_.points[0].skip = Infeasibility::kStep;
  EXPECT_EQ(Steps(), (std::vector<size_t>{0, 1}));
  plan_.points[0].skip = Infeasibility::kNone;
  for (size_t t = 8; t < 10; ++t) plan_.points[t].piece = 1;
  EXPECT_EQ(Steps(), (std::vector<size_t>{6, 7, 8}));
}

TEST_F(LargeStepsTest, NoneBesidePointsThatAreSkippedForAnythingElse) {
  plan_.points[3].skip = plan_.points[5].skip = Infeasibility::kInterference;
  plan_.points[4].skip = Infeasibility::kStep;
  EXPECT_EQ(Steps(), (std::vector<size_t>{}));
}

TEST_F(LargeStepsTest, OfARingAlsoTheStepBackToItsFirstPoint) {
  pass_.closed = true;
  plan_.points[0].q[5] += DegToRad(4.5);
  EXPECT_EQ(Steps(), (std::vector<size_t>{0, 1, 8, 9}));
}

}  // namespace
}  // namespace millpose
