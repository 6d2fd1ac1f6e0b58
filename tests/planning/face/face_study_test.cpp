// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/face_study.hpp"

#include <gtest/gtest.h>

#include "machine/identification/flatness.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr CutterShape kFlat{10, 0, 40};

/// A wall of 60 × 60 mm about the middle of the sample's passes, in P.
Region Wall() {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Vector3d(-20, -20, 0);
  return {Mesh(Moved(GridShape(30, 30, 2), X)), RegionOptions{}};
}

/// Passes at one rotation about the tool axis, so that errors of the tool are the same everywhere.
PlanResult AtOneRotation() {
  PlanResult plan = SamplePlan({.points = 6, .ring = false, .passes = 3});
  plan.arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points) point.q = plan.passes[0].points[0].q;
  return plan;
}

FaceStudy Studied(const PlanResult& plan, const StatedErrors& stated, int draws = 0, int threads = 2) {
  const FaceRays rays = MakeFaceRays(Wall(), 1), few = MakeFaceRays(Wall(), 3);
  return StudyFace(ErringPath(plan, {}, 0), kFlat, rays, few, stated, {draws, 7}, {threads});
}

TEST(FaceStudy, ToolWithoutErrorLeavesThePlane) {
  const FaceStudy study = Studied(AtOneRotation(), {});
  EXPECT_GT(study.flawless.figures.rays, 500u);
  EXPECT_NEAR(study.flawless.figures.heights.level, 0, 1e-8);
  EXPECT_NEAR(study.flawless.figures.flatness.value(), 0, 1e-8);
  EXPECT_FALSE(study.by_force);
  EXPECT_FALSE(study.by_lost);
  EXPECT_FALSE(study.drawn);
}

// The same force in the same pose everywhere: the level alone changes, and the tool's tilt under it.
TEST(FaceStudy, ConstantErrorIsLevel) {
  PlanResult plan = AtOneRotation();
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points) {
      point.point.feed = Vector3d::UnitY();
      point.point.engagement.force = -60 * point.point.normal + Vector3d(0, 30, 10);
    }
  StatedErrors stated;
  stated.force = true;
  const FaceStudy study = Studied(plan, stated);
  const double level = study.expected.figures.heights.level;
  EXPECT_GT(std::abs(level), 1e-3);
  EXPECT_LT(study.expected.figures.flatness.value(), 0.03 * std::abs(level));
  ASSERT_TRUE(study.by_force);
  EXPECT_EQ(study.by_force->heights.level, level);
}

// The part stands elsewhere than it was registered: the level is as unsure as that.
TEST(FaceStudy, DrawnPlacesOfThePartMoveTheLevel) {
  StatedErrors stated;
  stated.part = ProbeMatrix::Zero(6, 6);
  const PlanResult plan = AtOneRotation();
  const Vector3d normal = plan.X_WP.linear().transpose() * plan.passes[0].points[0].point.normal;
  stated.part->topLeftCorner<3, 3>() = 0.1 * normal * normal.transpose();
  const FaceStudy study = Studied(plan, stated, 400);
  ASSERT_TRUE(study.drawn);
  EXPECT_NEAR(study.drawn->level.high - study.drawn->level.low, 2 * 1.645 * 0.1, 0.04);
  EXPECT_NEAR(study.drawn->level.high + study.drawn->level.low, 0, 0.04);
  EXPECT_NEAR(study.drawn->added.high, 0, 1e-7);
  EXPECT_NEAR(study.expected.figures.heights.level, 0, 1e-8);
}

// Turned about its middle: heights differ across it, the mean does not.
TEST(FaceStudy, DrawnTurnsOfThePartTiltTheFace) {
  StatedErrors stated;
  stated.part = ProbeMatrix::Zero(6, 6);
  const PlanResult plan = AtOneRotation();
  const Vector3d normal = plan.X_WP.linear().transpose() * plan.passes[0].points[0].point.normal;
  const Vector3d along = normal.unitOrthogonal();
  stated.part->bottomRightCorner<3, 3>() = 1e-4 * along * along.transpose();
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      stated.part_centre +=
          plan.X_WP.inverse() * point.point.position / static_cast<double>(3 * pass.points.size());
  const FaceStudy study = Studied(plan, stated, 100);
  ASSERT_TRUE(study.drawn);
  EXPECT_GT(study.drawn->added.high, 2e-3);
  EXPECT_LT(study.drawn->level.high, 0.2 * study.drawn->added.high);
}

// Bent otherwise than it was registered: heights differ as the mode says.
TEST(FaceStudy, DrawnBendingOfThePartBendsTheFace) {
  constexpr double kSd = 0.05;
  StatedErrors stated;
  const PlanResult plan = AtOneRotation();
  const Vector3d normal = plan.X_WP.linear().transpose() * plan.passes[0].points[0].point.normal;
  std::vector<Vector3d> places;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      places.emplace_back(plan.X_WP.inverse() * point.point.position);
  for (const Vector3d& p : places) stated.part_bending.origin += p / static_cast<double>(places.size());
  stated.part_bending.u = 30 * normal.unitOrthogonal();
  stated.part_bending.v = normal.cross(stated.part_bending.u);
  stated.part_bending.modes = {0, 0, 0};
  stated.part = ProbeMatrix::Zero(9, 9);
  (*stated.part)(7, 7) = kSd;  // a twist: d = a·u·v
  double largest = 0;
  for (const Vector3d& p : places) {
    const Vector3d from = p - stated.part_bending.origin;
    largest = std::max(largest,
                       std::abs(from.dot(stated.part_bending.u) * from.dot(stated.part_bending.v)) / 810000);
  }
  const FaceStudy study = Studied(plan, stated, 200);
  ASSERT_TRUE(study.drawn);
  EXPECT_GT(study.drawn->added.high, largest * kSd);
  EXPECT_LT(study.drawn->added.high, 12 * largest * kSd);  // the face is wider than the tips by the cutter
  EXPECT_LT(study.drawn->level.high, 0.3 * study.drawn->added.high);
  EXPECT_NEAR(study.expected.figures.heights.level, 0, 1e-8);
}

// One gear with an error in one pose: what it displaces along the normal lies within the amplitude and, as
// the phase is anything, comes near either end.
TEST(FaceStudy, DrawnPhasesOfAGearsErrorMoveTheLevelByItsLever) {
  StatedErrors stated;
  stated.gears.emplace();
  stated.gears->amplitude[2] = 1e-4;
  stated.gears->periods.setConstant(80);
  const PlanResult plan = AtOneRotation();
  const PlannedPoint& point = plan.passes[0].points[0];
  const double lever =
      std::abs((plan.X_WB.linear().transpose() * point.point.normal)
                   .dot(Jacobian(plan.arm, point.q, plan.X_FT.translation()).col(2).head<3>()));
  const FaceStudy study = Studied(plan, stated, 400);
  ASSERT_TRUE(study.drawn);
  // 5 and 95 % of the sine of a uniform phase: ±sin(0.45 π).
  EXPECT_NEAR(study.drawn->level.high, 0.9877 * 1e-4 * lever, 0.02 * 1e-4 * lever);
  EXPECT_NEAR(study.drawn->level.low, -0.9877 * 1e-4 * lever, 0.02 * 1e-4 * lever);
}

TEST(FaceStudy, FiguresAreThoseOfItsPoints) {
  PlanResult plan = AtOneRotation();
  for (size_t i = 0; i < plan.passes.size(); ++i)  // steps between passes, and one that slants
    for (size_t t = 0; t < plan.passes[i].points.size(); ++t)
      plan.passes[i].points[t].point.position +=
          plan.passes[i].points[t].point.normal * (0.02 * (i % 2) - 0.001 * static_cast<double>(t * (i / 2)));
  const FaceRays rays = MakeFaceRays(Wall(), 1);
  const FaceStudy study = Studied(plan, {});
  const FaceFigures& face = study.flawless.figures;
  const Flatness measured = MeasureFlatness(SurfaceOf(rays, study.flawless.heights)).value();
  EXPECT_EQ(face.flatness.value(), measured.flatness);
  EXPECT_EQ(face.minimum_zone.value(), measured.minimum_zone);
  EXPECT_GT(face.flatness.value(), 0.005);
  EXPECT_LE(face.minimum_zone.value(), face.flatness.value());
  EXPECT_NEAR(face.heights.low, -0.005, 1e-8);
}

// An error that grows within passes: the largest range of one, and steps against the face without error.
TEST(FaceStudy, TellsPassesAndStepsApart) {
  const PlanResult flawless = AtOneRotation();
  PlanResult lower = flawless;
  for (PlannedPoint& point : lower.passes[1].points) point.point.position -= 0.04 * point.point.normal;
  for (size_t t = 0; t < lower.passes[2].points.size(); ++t)
    lower.passes[2].points[t].point.position -=
        0.002 * static_cast<double>(t) * lower.passes[2].points[t].point.normal;
  const FaceRays rays = MakeFaceRays(Wall(), 1);
  const auto heights = [&](const PlanResult& plan) {
    return SweptCutter(kFlat, ErringPath(plan, {}, 0).Motions({}), 15);
  };
  const SweptCutter good = heights(flawless), bad = heights(lower);
  const FaceFigures figures =
      FiguresOf(rays, bad.HeightsOn(rays.rays, 1), good.HeightsOn(rays.rays, 1), bad.motions(), false);
  ASSERT_TRUE(figures.step && figures.within);
  EXPECT_EQ(figures.within->pass, 2);
  EXPECT_NEAR(figures.within->range, 0.01, 1e-3);
  EXPECT_NEAR(figures.step->height, 0.04, 1e-3);
  EXPECT_EQ(std::max(figures.step->pass, figures.step->other_pass), 1);
  EXPECT_FALSE(figures.minimum_zone);
}

// Passes that just meet, and a tool that leans away from one of them: what then stays between them stands as
// high as the stock.
TEST(FaceStudy, CountsWhatIsLeftStanding) {
  PlanResult plan = AtOneRotation();
  plan.passes.resize(2);
  for (PlannedPoint& point : plan.passes[1].points)
    point.point.position = plan.X_WP * (plan.X_WP.inverse() * point.point.position + Vector3d(0, 11.999, 0));
  const FaceRays rays = MakeFaceRays(Wall(), 0.5);
  StatedErrors stated;
  const FaceStudy study = StudyFace(ErringPath(plan, {}, 0), kFlat, rays, rays, stated, {}, {2});
  EXPECT_EQ(study.expected.figures.standing, 0u);
  PlanResult apart = plan;
  for (PlannedPoint& point : apart.passes[1].points)
    point.point.position = plan.X_WP * (plan.X_WP.inverse() * point.point.position + Vector3d(0, 1, 0));
  const SweptCutter wide(kFlat, ErringPath(apart, {}, 0).Motions({}), 15);
  const FaceFigures figures =
      FiguresOf(rays, wide.HeightsOn(rays.rays, 1), study.flawless.heights, wide.motions(), false);
  EXPECT_GT(figures.standing, 20u);
  EXPECT_NEAR(figures.heights.high, 0, 1e-8);
}

// A tip that is known to 0.05 mm only: at one rotation every drawn face is flat, and somewhere within that.
TEST(FaceStudy, DrawsWithinWhatIsStated) {
  StatedErrors stated;
  stated.tip = 0.05;
  const FaceStudy study = Studied(AtOneRotation(), stated, 60);
  ASSERT_TRUE(study.drawn && study.drawn->flatness);
  EXPECT_EQ(study.drawn->count, 60);
  EXPECT_LT(study.drawn->flatness->high, 1e-7);
  EXPECT_LT(study.drawn->level.low, -0.01);
  EXPECT_GT(study.drawn->level.high, 0.01);
  EXPECT_GT(study.drawn->level.low, -0.05);
  EXPECT_LT(study.drawn->level.high, 0.05);
}

TEST(FaceStudy, IsTheSameForAnyThreads) {
  PlanResult plan = SamplePlan({.points = 6, .ring = true, .passes = 3});
  plan.arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points) {
      point.point.feed = Vector3d::UnitY();
      point.point.engagement.force = Vector3d(-40, 30, 10);
    }
  StatedErrors stated;
  stated.force = true;
  stated.force_share = 0.3;
  stated.force_angle = DegToRad(20);
  stated.lost = LostMotion();
  stated.lost->width.head<6>().setConstant(DegToRad(0.3 / 60));
  stated.lean = DegToRad(0.01);
  const FaceStudy one = Studied(plan, stated, 12, 1), three = Studied(plan, stated, 12, 3);
  for (size_t i = 0; i < one.expected.heights.size(); ++i)
    ASSERT_EQ(one.expected.heights[i].height, three.expected.heights[i].height);
  EXPECT_EQ(one.expected.figures.flatness, three.expected.figures.flatness);
  EXPECT_EQ(one.drawn->flatness->low, three.drawn->flatness->low);
  EXPECT_EQ(one.drawn->flatness->high, three.drawn->flatness->high);
  EXPECT_EQ(one.drawn->level.low, three.drawn->level.low);
  EXPECT_LT(one.drawn->level.low, one.drawn->level.high);
}

TEST(FaceStudy, WritesPointsAsAMeasuringMachineDoes) {
  const FaceRays rays = MakeFaceRays(Wall(), 4);
  std::vector<RayHeight> heights(rays.rays.size());
  heights[3] = {0.002, 0};
  const Vector3d& origin = rays.rays[3].origin;
  EXPECT_EQ(FaceCsv(rays, heights), fmt::format("x_mm,y_mm,z_mm,error_um\n{:.17g},{:.17g},{:.17g},{:.17g}\n",
                                                origin.x(), origin.y(), 0.002, 1000 * 0.002));
}

}  // namespace
}  // namespace millpose
