// SPDX-License-Identifier: GPL-3.0-or-later
// Where joints turn back in a plan, and what lost motion leaves of the tip.
#include "planning/result/gear_course.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kArcmin = kRadPerDeg / 60;

/// Joint `joint` goes through `degrees` from a pose, point by point; the normal is x of W.
PassResult PassOf(const PlanResult& plan, const std::vector<double>& degrees, int joint) {
  PassResult pass;
  for (const double angle : degrees) {
    PlannedPoint planned;
    planned.q = test::Degrees(0, -80, 100, 10, 40, 20);
    planned.q[joint] += DegToRad(angle);
    planned.point.position = plan.X_WB * ForwardFlange(plan.arm, planned.q) * plan.X_FT.translation();
    planned.point.normal = Vector3d::UnitX();
    pass.points.push_back(planned);
  }
  pass.pieces = {{0, 0, 0, static_cast<int>(degrees.size()) - 1, false}};
  return pass;
}

PlanResult PlanOf(const std::vector<double>& degrees, int joint) {
  PlanResult plan;
  plan.arm = test::SampleArm();
  plan.X_FT.translation() = Vector3d(-250, 0, 250);
  plan.X_WB = test::At(100, 50, 20);
  plan.passes = {PassOf(plan, degrees, joint)};
  return plan;
}

GearModel Known(double arcmin) {
  GearModel model;
  model.lost.width.head<6>().setConstant(arcmin * kArcmin);
  std::fill_n(model.known.begin(), 6, true);
  return model;
}

GearCourse Follow(const PlanResult& plan, const GearModel& model, int finished_from = 0) {
  return FollowGears(plan, model, OfFace(plan.passes, finished_from));
}

// One joint 0 → 1 → 0°: the tip's error along the normal steps by h·|n·J| where it turns back.
TEST(GearCourse, AMarkIsTheStepThatOneReversalLeaves) {
  for (int joint = 0; joint < 6; ++joint) {
    const PlanResult plan = PlanOf({0, 0.5, 1, 0.98, 0.5, 0}, joint);
    GearModel model = Known(0);
    model.lost.width[joint] = 0.3 * kArcmin;
    const GearCourse course = Follow(plan, model);
    ASSERT_EQ(course.marks.size(), 1u) << joint;
    const GearMark& mark = course.marks[0];
    EXPECT_EQ(mark.point, 2u);
    EXPECT_EQ(mark.gear, joint);
    EXPECT_TRUE(mark.turns && mark.crosses);
    const auto tip = [&](double by) {
      Joints q = plan.passes[0].points[2].q;
      q[joint] += by;
      return Vector3d(plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT.translation());
    };
    const double lever = std::abs((tip(1e-5) - tip(-1e-5)).x()) / 2e-5;
    EXPECT_NEAR(mark.lever, lever, 1e-6 * std::max(1.0, lever));
    EXPECT_DOUBLE_EQ(*HeightOf(mark, model), 0.3 * kArcmin * mark.lever);
    // Between the points before and behind the gap: the same step, up to the lever's change over 0.02°.
    EXPECT_NEAR(std::abs(*course.errors[3] - *course.errors[2]), *HeightOf(mark, model), 1e-4);
    const GearTally tally = TallyOf(course, model, {});
    EXPECT_EQ(tally.Turns(), 1);
    EXPECT_EQ(tally.turns[static_cast<size_t>(joint)], 1);
    EXPECT_DOUBLE_EQ(tally.sum, *HeightOf(mark, model));
    double worst = 0;
    for (const std::optional<double>& error : course.errors) worst = std::max(worst, std::abs(*error));
    EXPECT_EQ(tally.worst, worst);
  }
}

TEST(GearCourse, WithoutLostMotionReversalsAreCountedAndToldPerArcmin) {
  const PlanResult plan = PlanOf({0, 1, 0}, 2);
  const GearCourse course = Follow(plan, {});
  ASSERT_EQ(course.marks.size(), 1u);
  EXPECT_FALSE(HeightOf(course.marks[0], {}));
  EXPECT_FALSE(course.errors[1]);
  const GearCourse known = Follow(plan, Known(1));
  EXPECT_DOUBLE_EQ(HeightPerUnit(course.marks[0], {}), *HeightOf(known.marks[0], Known(1)));
  EXPECT_DOUBLE_EQ(TallyOf(course, {}, {}).sum, TallyOf(known, Known(1), {}).sum);
}

TEST(GearCourse, CountsWhatLeavesTheFaceAlone) {
  PlanResult plan = PlanOf({0, 1, 0, 1, 0}, 3);
  const auto marks = [&](int finished_from = 0) {
    return Follow(plan, Known(1), finished_from).marks.size();
  };
  EXPECT_EQ(marks(), 3u);
  EXPECT_EQ(marks(1), 0u) << "a layer above";
  plan.passes[0].points[1].point.kind = PointKind::kLeadIn;
  EXPECT_EQ(marks(), 2u);
  for (const size_t i : {0, 2, 4}) plan.passes[0].points[i].point.engagement.side = CutSide::kUp;
  EXPECT_EQ(marks(), 1u) << "the third is in air";
}

// Entered settled whatever came before: passes do not depend on each other.
TEST(GearCourse, EveryPieceIsEnteredSettled) {
  PlanResult plan = PlanOf({0, 1, 2}, 1);
  PassResult back = PassOf(plan, {2, 1, 0}, 1);
  back.pass = 1;
  back.pieces[0].pass = 1;
  plan.passes.push_back(back);
  GearModel model = Known(0);
  model.lost.width[1] = 0.3 * kArcmin;
  const GearCourse course = Follow(plan, model);
  EXPECT_TRUE(course.marks.empty());
  for (size_t t = 0; t < 3; ++t)  // the same pose, gone through the other way: the other flank
    EXPECT_NEAR(*course.errors[t], -*course.errors[5 - t], 1e-12);
  plan.passes[0].pieces = {{0, 0, 0, 1, false}, {0, 1, 2, 2, false}};
  EXPECT_TRUE(Follow(plan, model).marks.empty());
}

TEST(GearCourse, AClosedPieceComesBackToItsFirstPoint) {
  PlanResult plan = PlanOf({0, 0.5, 1, 0.5}, 4);
  EXPECT_EQ(Follow(plan, Known(1)).marks.size(), 1u);
  plan.passes[0].pieces[0].closed = true;
  const GearCourse course = Follow(plan, Known(1));
  EXPECT_EQ(course.marks.size(), 1u) << "turning back at the first point, where it is left, is none";
  // A full revolution of the wrist goes on.
  plan = PlanOf({0, 90, 180, 270}, 5);
  plan.passes[0].pieces[0].closed = true;
  EXPECT_TRUE(Follow(plan, Known(1)).marks.empty());
}

TEST(GearCourse, WeightHoldsAJointOnItsFlank) {
  PlanResult plan = PlanOf({0, 1, 0}, 1);
  GearModel model = Known(0.3);
  model.weights = GearWeights{{{"arm", 2, 500, Vector3d(600, 0, 0)}}, {}, Vector3d(0, 0, -9810)};
  model.lost.friction.head<6>().setConstant(1e5);
  const GearCourse loaded = Follow(plan, model);
  ASSERT_EQ(loaded.marks.size(), 1u);
  EXPECT_TRUE(loaded.marks[0].turns);
  EXPECT_FALSE(loaded.marks[0].crosses);
  EXPECT_EQ(*HeightOf(loaded.marks[0], model), 0);
  EXPECT_EQ(TallyOf(loaded, model, {}).largest, 0);
  model.lost.friction.head<6>().setConstant(1e8);
  EXPECT_TRUE(Follow(plan, model).marks[0].crosses);
}

// A rail that carries the robot and a table that carries the part: the way of the tip against the part.
TEST(GearCourse, ExternalAxesAreGearsToo) {
  PlanResult plan = PlanOf({0, 0.001, 0.002}, 0);
  plan.external_axes = {{.name = "rail", .direction = Vector3d::UnitX(), .compliance = {}},
                        {.name = "table",
                         .kind = AxisKind::kRotary,
                         .carries = Carries::kWorkpiece,
                         .direction = Vector3d::UnitZ(),
                         .origin = Vector3d(0, -500, 0),
                         .compliance = {}}};
  PassResult& pass = plan.passes[0];
  for (size_t t = 0; t < 3; ++t) {
    const double there = t == 1 ? 1 : 0;
    pass.points[t].external = ExternalPosition{there, DegToRad(there)};
    pass.points[t].point.position = BaseAt(plan, *pass.points[t].external) *
                                    ForwardFlange(plan.arm, pass.points[t].q) * plan.X_FT.translation();
  }
  GearModel model;
  model.lost.dead_zone[6] = kLinearDeadZone;
  model.lost.width[6] = 0.02;
  model.known[6] = true;
  const GearCourse course = Follow(plan, model);
  ASSERT_EQ(course.marks.size(), 2u);
  EXPECT_EQ(course.marks[0].gear, 6);
  EXPECT_NEAR(course.marks[0].lever, 1, 1e-12);
  EXPECT_NEAR(*HeightOf(course.marks[0], model), 0.02, 1e-12);
  EXPECT_EQ(course.marks[1].gear, 7);
  EXPECT_NEAR(course.marks[1].lever, std::abs(pass.points[1].point.position.y() + 500), 1e-9);
  EXPECT_FALSE(HeightOf(course.marks[1], model));
  EXPECT_NEAR(*course.errors[0], -0.01, 1e-12);
  EXPECT_NEAR(*course.errors[2], 0.01, 1e-12);
}

// A hole's joints turn back with every peck, and leave nothing on a face.
TEST(GearCourse, DrilledHolesHaveNoFace) {
  PlanResult plan = PlanOf({0, 1, 0, 1, 0}, 2);
  GearModel model = Known(0.3);
  ASSERT_FALSE(Follow(plan, model).marks.empty());
  double deep = 0;
  for (PlannedPoint& point : plan.passes.front().points) {
    point.point.tool_axis = Vector3d::UnitZ();
    point.point.position = Vector3d(10, 20, 5 - (deep = 3 - deep));
  }
  EXPECT_TRUE(Follow(plan, model).marks.empty());
  plan.passes.front().points.back().point.position.x() += 0.5;  // a slot
  EXPECT_FALSE(Follow(plan, model).marks.empty());
}

}  // namespace
}  // namespace millpose
