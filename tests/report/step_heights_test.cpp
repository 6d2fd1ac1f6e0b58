// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/step_heights.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"

namespace millpose {
namespace {

const ToolUncertainty kTool{0.1, DegToRad(0.5), 10};

TEST(StepHeight, IsWhatAnErrorFixedInTheToolMovesByWhenItTurns) {
  // A tip that lies off by 0.1 mm, on a circle about the axis: the chord between the two places.
  for (const double rotation : {0.0, 0.3, 2.0, kPi}) {
    const Eigen::Vector2d from(0.1, 0), to(0.1 * std::cos(rotation), 0.1 * std::sin(rotation));
    EXPECT_NEAR(StepHeight({0.1, 0, 10}, rotation, false), (to - from).norm(), 1e-15);
  }
  // The edge of a cutter that leans by 0.5°: R · axis high on one side, as deep on the other.
  EXPECT_NEAR(StepHeight({0, kTool.axis, 10}, kPi, false), 2 * 10 * DegToRad(0.5), 1e-15);
  EXPECT_NEAR(StepHeight(kTool, 0, true), 2 * (0.1 + 10 * DegToRad(0.5)), 1e-15) << "another branch";
}

PassResult Line(int number, double y, double rotation) {
  PassResult pass;
  pass.pass = number;
  for (int t = 0; t < 6; ++t) {
    PlannedPoint& point = pass.points.emplace_back();
    point.point.position = {10.0 * t, y, 0};
    point.freedoms = {rotation};
  }
  pass.pieces.push_back({number, 0, 0, 5, false});
  return pass;
}

TEST(PoseSteps, AreFoundWherePartsMeetAndBetweenPassesThatTouch) {
  PlanResult plan;
  plan.passes = {Line(0, 0, 0), Line(1, 15, DegToRad(60)), Line(2, 60, DegToRad(180))};
  // The second is lifted before its fourth point, which follows a lead, and turned a little from there.
  PassResult& lifted = plan.passes[1];
  lifted.pieces = {{1, 0, 0, 2, false}, {1, 1, 3, 5, false}};
  lifted.points[3].point.kind = PointKind::kLeadIn;
  for (int t = 3; t < 6; ++t) lifted.points[static_cast<size_t>(t)].freedoms = {DegToRad(80)};
  lifted.lifts = {1};
  const PoseSteps steps = FindPoseSteps(plan, kTool);
  ASSERT_EQ(steps.parts.size(), 1u);
  EXPECT_EQ(steps.parts[0].why, PoseStep::Why::kLift);
  EXPECT_EQ(steps.parts[0].point, 8u);
  EXPECT_EQ(steps.parts[0].other, 10u) << "leads do not count";
  EXPECT_NEAR(steps.parts[0].rotation, DegToRad(20), 1e-12);
  ASSERT_TRUE(steps.neighbours.has_value());
  EXPECT_NEAR(steps.neighbours->rotation, DegToRad(80), 1e-12) << "the third pass is too far away";
  EXPECT_NEAR(steps.neighbours->height, StepHeight(kTool, DegToRad(80), false), 1e-15);
  lifted.points[5].branch = 2;
  EXPECT_NEAR(FindPoseSteps(plan, kTool).neighbours->height, StepHeight(kTool, 0, true), 1e-15);
  EXPECT_FALSE(FindPoseSteps(plan, kTool, 2).neighbours.has_value()) << "one pass finishes the face";
  lifted.lifts.clear();
  EXPECT_EQ(FindPoseSteps(plan, kTool).parts[0].why, PoseStep::Why::kSplit);
  EXPECT_NE(Describe(steps).find("points 8 and 10"), std::string::npos) << Describe(steps);
  EXPECT_EQ(Describe(FindPoseSteps({}, kTool)), "");
}

TEST(PoseSteps, AtOnePointAreItsOwnPartsAndItsNearestNeighbour) {
  PlanResult plan;
  plan.passes = {Line(0, 0, 0), Line(1, 15, DegToRad(60)), Line(2, 60, DegToRad(180))};
  plan.passes[1].pieces = {{1, 0, 0, 2, false}, {1, 1, 3, 5, false}};
  plan.passes[1].points[3].freedoms = {DegToRad(80)};
  const PoseSteps all = FindPoseSteps(plan, kTool);
  double highest = 0;
  size_t parts = 0;
  for (size_t point = 0; point < 18; ++point)
    for (const PoseStep& step : FindPoseStepsAt(plan, kTool, 0, point)) {
      EXPECT_TRUE(step.point == point || step.other == point);
      EXPECT_LT(point, 12u) << "the third pass is too far away";
      if (step.why == PoseStep::Why::kNeighbours)
        highest = std::max(highest, step.height);
      else
        ++parts;
    }
  EXPECT_EQ(highest, all.neighbours->height);
  EXPECT_EQ(parts, 2 * all.parts.size()) << "each from both its ends";
  const std::vector<PoseStep> split = FindPoseStepsAt(plan, kTool, 0, 9);
  ASSERT_EQ(split.size(), 2u);
  EXPECT_EQ(split[0].why, PoseStep::Why::kSplit);
  EXPECT_EQ(split[1].other, 3u);
  EXPECT_EQ(split[1].height, StepHeight(kTool, DegToRad(80), false));
  EXPECT_TRUE(FindPoseStepsAt(plan, kTool, 1, 3).empty()) << "its pass is cut away again";
}

TEST(PoseSteps, ARingLeftOpenMeetsItself) {
  PlanResult plan;
  plan.passes = {Line(0, 0, 0)};
  plan.passes[0].opened_at = 2;
  plan.passes[0].points[5].freedoms = {DegToRad(-150)};
  const PoseSteps steps = FindPoseSteps(plan, kTool);
  ASSERT_EQ(steps.parts.size(), 1u);
  EXPECT_EQ(steps.parts[0].why, PoseStep::Why::kRing);
  EXPECT_NEAR(steps.parts[0].rotation, DegToRad(150), 1e-12);
}

}  // namespace
}  // namespace millpose
