// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/deflection.hpp"

#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

PlanResult TwoPasses() {
  PlanResult plan;
  plan.arm = Kr500R2830();
  plan.X_FT.translation() << -250, 0, 250;
  plan.stiffness_origin = StiffnessOrigin::kToolTip;
  for (int pass = 0; pass < 2; ++pass) {
    PassResult result;
    result.pass = pass;
    for (int i = 0; i < 4; ++i) {
      PlannedPoint planned;
      planned.q = Degrees(3 * i, -80, 100 + pass, 10, 40, 0);
      planned.point.position = plan.X_WB * ForwardFlange(plan.arm, planned.q) * plan.X_FT.translation();
      planned.point.normal = planned.point.tool_axis = Eigen::Vector3d(-1, 0, 0);
      planned.point.feed = Eigen::Vector3d(0, 1, 0);
      planned.point.engagement = {Eigen::Vector3d(-10, 30, 50), 6, 1, CutSide::kUp};
      if (i == 1) planned.skip = Infeasibility::kLimit;
      if (i == 3) planned.point.kind = PointKind::kLeadOut;
      result.points.push_back(planned);
    }
    plan.passes.push_back(result);
  }
  return plan;
}

TEST(Deflection, IsComplianceTimesForceAtEveryPlannedCutPoint) {
  const PlanResult plan = TwoPasses();
  const DeflectionReport report = PredictDeflections(plan, {}, {});
  ASSERT_EQ(report.points.size(), 4u);
  const std::array<size_t, 4> numbers{0, 2, 4, 6};
  const Eigen::Vector3d F(-10, 30, 50);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(report.points[k].number, numbers[k]);
    const Joints& q = plan.passes[k / 2].points[k % 2 == 0 ? 0 : 2].q;
    const Eigen::Vector3d moved =
        Compliance(Jacobian(plan.arm, q, plan.X_FT.translation()), plan.arm.stiffness).topLeftCorner<3, 3>() *
        F;
    EXPECT_NEAR(report.points[k].deflection.normal, -moved.x(), 1e-12);
    EXPECT_NEAR(report.points[k].deflection.feed, moved.y(), 1e-12);
    EXPECT_NEAR(report.points[k].deflection.length, moved.norm(), 1e-12);
  }
  ASSERT_TRUE(report.face.has_value());
  EXPECT_NEAR(report.points[0].moved.x(), -report.points[0].deflection.normal, 1e-15);  // P is W here
  const std::string csv = BytesOf([&](const ByteSink& sink) { WriteDeflectionCsv(report, 1, sink); });
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_TRUE(csv.starts_with("point,pass,side,width_mm,depth_mm,force_x_N,"));
  EXPECT_NE(csv.find("\n2,0,up,6,1,-10,30,50,"), std::string::npos) << csv;
}

TEST(Deflection, VectorsAreInThePartsFrame) {
  PlanResult plan = TwoPasses();
  const Eigen::Vector3d in_world = PredictDeflections(plan, {}, {}).points[2].moved;
  plan.X_WP.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  plan.X_WP.translation() << 5, 6, 7;
  const Eigen::Vector3d in_part = PredictDeflections(plan, {}, {}).points[2].moved;
  EXPECT_LT((plan.X_WP.linear() * in_part - in_world).norm(), 1e-15);
}

TEST(Deflection, OnlyTheLastLayerIsTheFinishedFace) {
  const PlanResult plan = TwoPasses();
  const DeflectionReport report = PredictDeflections(plan, {}, {}, 1);
  EXPECT_EQ(report.points.size(), 4u);    // every point is predicted,
  EXPECT_FALSE(report.face.has_value());  // but the second pass alone has two points
}

TEST(Deflection, PointsInAirAreNotPartOfTheFace) {
  PlanResult plan = TwoPasses();
  plan.passes[0].points[0].point.engagement = {};
  const DeflectionReport report = PredictDeflections(plan, {}, {});
  ASSERT_EQ(report.points.size(), 4u);
  EXPECT_EQ(report.points[0].deflection.length, 0);
  ASSERT_TRUE(report.face.has_value());
  double level = 0;
  for (size_t i = 1; i < 4; ++i) level += report.points[i].deflection.normal / 3;
  EXPECT_NEAR(report.face->level, level, 1e-15);
}

TEST(Deflection, CountsCompliancesBesideTheJoints) {
  PlanResult plan = TwoPasses();
  plan.passes[0].points[0].point.engagement.force = -100 * plan.passes[0].points[0].point.normal;
  SeriesCompliance soft;
  soft.link = 0;
  soft.C.diagonal().head<3>().setConstant(1e-3);
  const double with = PredictDeflections(plan, {}, {soft}).points[0].deflection.normal;
  const double without = PredictDeflections(plan, {}, {}).points[0].deflection.normal;
  EXPECT_NEAR(with - without, -0.1, 1e-12);
}

}  // namespace
}  // namespace millpose
