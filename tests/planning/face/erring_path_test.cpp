// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/erring_path.hpp"

#include <gtest/gtest.h>

#include "base/decompositions.hpp"
#include "base/rotation.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kArcmin = kRadPerDeg / 60;

/// Two straight passes, every point under `force` (W, N).
PlanResult Loaded(const Vector3d& force) {
  PlanResult plan = SamplePlan({.points = 9, .ring = false});
  plan.arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points) {
      point.point.engagement.force = force;
      point.point.feed = Vector3d::UnitY();
    }
  return plan;
}

const PlannedPoint& FirstOf(const PlanResult& plan) { return plan.passes[0].points[0]; }

TEST(ErringPath, IsThePlansOwnWithoutErrors) {
  const PlanResult plan = Loaded({10, 20, 30});
  const std::vector<CutterMotion> motions = ErringPath(plan, {}, 0).Motions({});
  ASSERT_EQ(motions.size(), 16u);
  const Pose X_PW = plan.X_WP.inverse();
  for (size_t i = 0; i < motions.size(); ++i) {
    const auto& points = plan.passes[i / 8].points;
    EXPECT_EQ(motions[i].pass, static_cast<int>(i / 8));
    EXPECT_LT((motions[i].from.tip - X_PW * points[i % 8].point.position).norm(), 1e-12);
    EXPECT_LT((motions[i].to.tip - X_PW * points[i % 8 + 1].point.position).norm(), 1e-12);
    EXPECT_LT((motions[i].from.axis - X_PW.linear() * points[i % 8].point.tool_axis).norm(), 1e-12);
  }
  EXPECT_EQ(ErringPath(plan, {}, 1).Motions({}).size(), 8u);  // of the last pass alone
}

// c·F by joints that are turned one by one by their torque ÷ stiffness, without compliance matrices.
TEST(ErringPath, YieldsAsTheJointsDo) {
  const Vector3d force(-70, 40, 25);
  const PlanResult plan = Loaded(force);
  const PlannedPoint& point = FirstOf(plan);
  ToolErrors errors;
  errors.force = 1;
  const CutterPlace place = ErringPath(plan, {}, 0).Motions(errors)[0].from;
  Joints q = point.q;
  const double step = 1e-6;
  const auto tool = [&](const Joints& at) { return plan.X_WB * ForwardFlange(plan.arm, at) * plan.X_FT; };
  for (int j = 0; j < 6; ++j) {
    Joints up = point.q, down = point.q;
    up[j] += step, down[j] -= step;
    const Vector3d lever = (tool(up).translation() - tool(down).translation()) / (2 * step);
    q[j] += lever.dot(force) / plan.arm.stiffness[j];
  }
  const Pose X_PW = plan.X_WP.inverse();
  const Vector3d moved = X_PW.linear() * (tool(q).translation() - tool(point.q).translation());
  EXPECT_GT(moved.norm(), 0.01);
  EXPECT_LT((place.tip - X_PW * point.point.position - moved).norm(), 1e-4 * moved.norm());
  EXPECT_LT((place.axis - X_PW.linear() * tool(q).linear().col(2)).norm(), 1e-8);
  errors.force = 2;
  const Vector3d twice = ErringPath(plan, {}, 0).Motions(errors)[0].from.tip - X_PW * point.point.position;
  EXPECT_LT((twice - 2 * (place.tip - X_PW * point.point.position)).norm(), 1e-12);
}

TEST(ErringPath, TurnsTheForcesInTheFrameOfTheFeed) {
  PlanResult along = Loaded(Vector3d::UnitY() * 50), across = Loaded(Vector3d::Zero());
  for (PassResult& pass : across.passes)
    for (PlannedPoint& point : pass.points)
      point.point.engagement.force = 50 * point.point.normal.cross(point.point.feed).normalized();
  ToolErrors plain, turned;
  plain.force = turned.force = 1;
  turned.force_turn = RotationAbout(Vector3d::UnitZ(), kPi / 2);  // feed to normal × feed
  const auto first = ErringPath(along, {}, 0).Motions(turned),
             second = ErringPath(across, {}, 0).Motions(plain);
  for (size_t i = 0; i < first.size(); ++i) EXPECT_LT((first[i].to.tip - second[i].to.tip).norm(), 1e-10);
}

// One joint 0 → 1 → 0°: at the same angle the tip comes back h·R beside where it was, R its distance from the
// joint's axis.
TEST(ErringPath, StepsByGapTimesLeverWhereAJointTurnsBack) {
  PlanResult plan = Loaded(Vector3d::Zero());
  plan.passes.resize(1);
  PassResult& pass = plan.passes[0];
  const Joints q0 = pass.points[0].q;
  for (int i = 0; i < 9; ++i) {
    PlannedPoint& point = pass.points[static_cast<size_t>(i)];
    point.q = q0;
    point.q[0] += DegToRad(0.25) * (i <= 4 ? i : 8 - i);
    const Pose X_WT = plan.X_WB * ForwardFlange(plan.arm, point.q) * plan.X_FT;
    point.point.position = X_WT.translation();
    point.point.tool_axis = X_WT.linear().col(2);
  }
  ToolErrors errors;
  errors.lost.width[0] = 0.3 * kArcmin;
  const std::vector<CutterMotion> motions = ErringPath(plan, {}, 0).Motions(errors);
  const Vector3d tip = plan.X_WB.inverse() * pass.points[2].point.position;
  const double step = errors.lost.width[0] * tip.head<2>().norm();
  EXPECT_GT(step, 0.1);
  for (int i = 0; i < 4; ++i) {
    const Vector3d going = motions[static_cast<size_t>(i)].from.tip,
                   back = motions[static_cast<size_t>(7 - i)].to.tip;
    EXPECT_NEAR((going - back).norm(), step, 1e-4 * step) << i;
  }
  // Nothing but axis 1 errs, and the same way as long as it goes on.
  errors.lost.width[0] = 0;
  errors.lost.width[3] = 0.3 * kArcmin;
  const std::vector<CutterMotion> still = ErringPath(plan, {}, 0).Motions(errors);
  EXPECT_LT((still[0].from.tip - still[7].to.tip).norm(), 1e-9);
}

TEST(ErringPath, CarriesTheToolsOwnError) {
  const PlanResult plan = Loaded(Vector3d::Zero());
  ToolErrors errors;
  errors.tip = Vector3d(0.01, -0.02, 0.03);
  const CutterPlace place = ErringPath(plan, {}, 0).Motions(errors)[0].from;
  const Pose X_PT = plan.X_WP.inverse() * plan.X_WB * ForwardFlange(plan.arm, FirstOf(plan).q) * plan.X_FT;
  EXPECT_LT((place.tip - X_PT * errors.tip).norm(), 1e-9);
}

// The tool goes where the arm as it is has it, against the part as measured with it: what is left of the tip
// sums up to nothing along the normals, for any shift and turn of the frame.
TEST(ErringPath, FollowsTheArmAsItIsAgainstThePartAsItMeasuresIt) {
  const PlanResult plan = Loaded(Vector3d::Zero());
  ArmDeviations deviations;
  for (size_t i = 0; i < 7; ++i) {
    const double k = static_cast<double>(i);
    deviations.shift[i] = 0.2 * Vector3d(std::cos(k), std::sin(2 * k), std::cos(3 * k));
    deviations.turn[i] = 3e-4 * Vector3d(std::sin(k), std::cos(2 * k), std::sin(3 * k));
  }
  ToolErrors errors;
  errors.geometry = true;
  const ErringPath path(plan, {}, 0, {}, &deviations);
  const std::vector<CutterMotion> nominal = path.Motions({}), own = path.Motions(errors);
  // Against the arm's own way and one frame for all, by a solver of its own.
  const Pose X_PW = plan.X_WP.inverse();
  Eigen::MatrixXd rows(18, 6);
  Eigen::VectorXd off(18);
  std::vector<Vector3d> moved;
  for (int i = 0; i < 18; ++i) {
    const PlannedPoint& point = plan.passes[static_cast<size_t>(i / 9)].points[static_cast<size_t>(i % 9)];
    const Vector3d n = X_PW.linear() * point.point.normal, at = X_PW * point.point.position;
    const Vector3d true_tip =
        X_PW * (plan.X_WB * (TrueFlange(plan.arm, deviations, point.q) * plan.X_FT.translation()));
    moved.push_back(true_tip - at);
    rows.row(i) << n.transpose(), at.cross(n).transpose() / 1000;
    off[i] = n.dot(moved.back());
  }
  const Eigen::VectorXd left = off - rows * LeastSquares(rows, off, 1e-9);
  ASSERT_EQ(own.size(), 16u);
  EXPECT_GT(off.cwiseAbs().maxCoeff(), 0.1);
  for (size_t i = 0; i < own.size(); ++i) {
    const int point = static_cast<int>(i / 8 * 9 + i % 8);
    const Vector3d n = rows.row(point).head<3>();
    EXPECT_NEAR(n.dot(own[i].from.tip - nominal[i].from.tip), left[point], 1e-6) << i;
  }
  // The direction turns with the arm too.
  EXPECT_GT((own[0].from.axis - nominal[0].from.axis).norm(), 1e-5);
  // A base that stands elsewhere is what the frame takes up.
  ArmDeviations base;
  base.shift[0] = {0.3, -0.2, 0.5};
  const std::vector<CutterMotion> shifted = ErringPath(plan, {}, 0, {}, &base).Motions(errors);
  for (size_t i = 0; i < shifted.size(); ++i) {
    const Vector3d n = X_PW.linear() * plan.passes[i / 8].points[i % 8].point.normal;
    EXPECT_NEAR(n.dot(shifted[i].from.tip - nominal[i].from.tip), 0, 1e-6);
  }
}

}  // namespace
}  // namespace millpose
