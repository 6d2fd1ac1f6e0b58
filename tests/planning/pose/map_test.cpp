// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/map.hpp"

#include "machine/stiffness/pose_stiffness.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

MapRequest SmallMap(const std::string& index) {
  MapRequest request;
  request.arm = Kr500R2830();
  request.lower = request.arm.lower;
  request.upper = request.arm.upper;
  request.X_FT.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // T's z along the flange's x
  request.X_FT.translation() = Vector3d(-250, 0, 250);
  request.origin = Vector3d(1200, 0, 200);
  request.u = Vector3d(300, 0, 0);
  request.v = Vector3d(0, 0, 400);
  request.u_count = 8;
  request.v_count = 5;
  request.tool_axis = request.normal = -Vector3d::UnitX();
  request.index = index;
  request.rotation_step = DegToRad(15);
  return request;
}

TEST(Map, ValuesAreThoseOfTheirPoses) {
  for (const MapIndex& index : MapIndices()) {
    const MapRequest request = SmallMap(index.name);
    int reached = 0;
    for (const MapPoint& at : DrawMap(request)) {
      if (!at.reached) continue;
      ++reached;
      const Pose X_BT = ForwardFlange(request.arm, at.q) * request.X_FT;
      EXPECT_LT((X_BT.translation() - at.point).norm(), 1e-8);
      EXPECT_LT((X_BT.linear().col(2) - request.tool_axis).norm(), 1e-10);
      EXPECT_EQ(Status(request.arm, at.q), at.branch);
      EXPECT_TRUE(at.rotation >= -kPi && at.rotation < kPi) << at.rotation;
      EXPECT_TRUE((at.q.array() >= request.lower.array()).all() &&
                  (at.q.array() <= request.upper.array()).all());
      const PoseStiffness whole = EvaluatePose(request.arm, at.q, request.X_FT.translation(), request.normal,
                                               request.characteristic_length);
      const auto& deflections = whole.deflections;
      const std::map<std::string, double> expected{
          {"dexterity", whole.dexterity},
          {"mu", whole.indices->mu},
          {"lambda_t1", whole.indices->lambda_t1},
          {"lambda_t2", whole.indices->lambda_t2},
          {"lambda_n", whole.indices->lambda_n},
          {"normal_deflection", deflections.normal},
          {"in_plane_deflection", deflections.in_plane},
          {"worst_in_plane", deflections.largest},
          {"cross_deflection", deflections.cross},
          {"isotropy", 1 / whole.indices->mu},
          {"drilling", deflections.normal},  // the axis is the normal here
          {"chen2021", 0.5 * whole.indices->lambda_t2 + 0.5 * whole.indices->lambda_n}};
      if (!expected.contains(index.name)) continue;  // a further objective, with a test of its own
      EXPECT_NEAR(at.value / expected.at(index.name), 1, 1e-7) << index.name;
    }
    EXPECT_GT(reached, 10);
    EXPECT_LT(reached, 40);  // the far corner is out of reach
  }
}

TEST(Map, CountsCompliancesBesideTheJoints) {
  for (const int link : {0, 4, 6}) {
    MapRequest request = SmallMap("normal_deflection");
    SeriesCompliance element;
    element.link = link;
    element.X_LK.linear() = Eigen::AngleAxisd(0.5, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    element.C.diagonal() << 1e-4, 2e-4, 5e-5, 1e-9, 2e-9, 3e-9;
    request.elements = {element};
    const std::vector<MapPoint> plain = DrawMap(SmallMap("normal_deflection"));
    const std::vector<MapPoint> with = DrawMap(request);
    int reached = 0;
    for (size_t i = 0; i < with.size(); ++i) {
      ASSERT_EQ(with[i].reached, plain[i].reached);
      if (!with[i].reached) continue;
      ++reached;
      const PoseStiffness whole =
          EvaluatePose(request.arm, with[i].q, request.X_FT.translation(), request.normal,
                       request.characteristic_length, request.elements);
      EXPECT_NEAR(with[i].value / whole.deflections.normal, 1, 1e-7);
      EXPECT_GT(with[i].value, plain[i].value + 4e-5);
    }
    EXPECT_GT(reached, 10);
  }
}

TEST(Map, IsTheBestOfAFinerLook) {
  for (const MapIndex& index : MapIndices()) {
    const bool greatest = index.name == "dexterity" || index.name == "mu";
    const MapRequest coarse = SmallMap(index.name);
    MapRequest fine = coarse;
    fine.rotation_step = coarse.rotation_step / 3;  // holds the coarse grid's rotations
    const std::vector<MapPoint> a = DrawMap(coarse), b = DrawMap(fine);
    for (size_t i = 0; i < a.size(); ++i) {
      if (!a[i].reached) continue;
      const double better = greatest ? b[i].value - a[i].value : a[i].value - b[i].value;
      EXPECT_GE(better, -1e-12 * std::abs(a[i].value)) << index.name;
    }
  }
}

TEST(Map, HoldsAtTheFlangeWhereAsked) {
  MapRequest request = SmallMap("normal_deflection");
  request.at_flange = true;
  int reached = 0;
  for (const MapPoint& at : DrawMap(request)) {
    if (!at.reached) continue;
    ++reached;
    const PoseStiffness flange = EvaluatePose(request.arm, at.q, Vector3d::Zero(), request.normal, 1000);
    EXPECT_NEAR(at.value / flange.deflections.normal, 1, 1e-7);
  }
  EXPECT_GT(reached, 10);
}

TEST(Map, TextsHaveOneLineAPoint) {
  const MapRequest request = SmallMap("mu");
  const std::vector<MapPoint> points = DrawMap(request);
  const std::string csv = MapToCsv(request, points), vtk = MapToVtk(request, points);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 41);
  EXPECT_TRUE(csv.starts_with("x_mm,y_mm,z_mm,mu,rotation_deg,branch,a1_deg"));
  for (size_t start = 0, end; (end = csv.find('\n', start)) != std::string::npos; start = end + 1)
    EXPECT_EQ(std::count(csv.begin() + start, csv.begin() + end, ','), 11);
  EXPECT_NE(vtk.find("DIMENSIONS 8 5 1\nPOINTS 40 double"), std::string::npos);
  EXPECT_EQ(vtk.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace millpose
