// SPDX-License-Identifier: GPL-3.0-or-later
// Pose problems and milling points that several tests use.
#pragma once

#include <span>

#include "planning/pose/search.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {

/// The tool of cells/kr500_r2830.yaml: tip at (−250, 0, 250) in the flange, T's z along flange X, T's x along
/// flange Z.
inline Pose SideSpindle() {
  Pose X_FT = Pose::Identity();
  X_FT.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  X_FT.translation() << -250, 0, 250;
  return X_FT;
}

inline PoseProblem MakeProblem(const Arm& arm, double margin_deg = 3) {
  PoseProblem problem;
  problem.arm = arm;
  problem.X_WB = Pose::Identity();
  problem.X_FT = SideSpindle();
  problem.bounds.lower = arm.lower.array() + DegToRad(margin_deg);
  problem.bounds.upper = arm.upper.array() - DegToRad(margin_deg);
  problem.bounds.wrist_min = 0.05;
  problem.bounds.elbow_min = 0.05;
  problem.bounds.shoulder_min_mm = 50;
  problem.freedoms.push_back(RotationAboutTool());
  problem.objective = MakeObjective("chen2021", {});
  return problem;
}

/// A point of a vertical panel in front of the arm, bent about the vertical with radius 1,500 mm: `y` and `z`
/// from (front, 0, height), in the world.
inline MillingPoint PanelPoint(double y, double z, double front = 1900, double height = 1100) {
  constexpr double kRadius = 1500;
  const double angle = y / kRadius;
  MillingPoint point;
  point.normal = Eigen::Vector3d(-std::cos(angle), std::sin(angle), 0);
  point.position =
      Eigen::Vector3d(front + kRadius * (1 - std::cos(angle)), kRadius * std::sin(angle), height + z);
  point.tool_axis = point.normal;
  point.feed = Eigen::Vector3d::UnitZ().cross(point.normal);
  point.feed_rate = 10;
  return point;
}

/// The first pose of Table 6 of Chen 2021 as a milling point for the arm that explains it, in Table 5's
/// limits without a margin.
struct PaperCase {
  PoseProblem problem;
  MillingPoint point;
  Joints pose1;
};
inline PaperCase MakePaperCase() {
  PaperCase paper{
      MakeProblem(Chen2021Table6(), 0), {}, Degrees(-4.512, -63.932, 103.263, 18.839, 53.130, 16.206)};
  PoseProblem& problem = paper.problem;
  problem.bounds.lower = Degrees(-45, -140, 38, -350, -118, -350).cwiseMax(problem.arm.lower);
  problem.bounds.upper = Degrees(45, -30, 120, 350, 106, 350).cwiseMin(problem.arm.upper);
  const Eigen::Vector3d axis = Eigen::Vector3d(0.999833, -0.018257, 0.000586).normalized();
  Pose X_FT = Pose::Identity();
  X_FT.linear().col(2) = axis;
  X_FT.linear().col(0) = (Eigen::Vector3d::UnitZ() - axis.z() * axis).normalized();
  X_FT.linear().col(1) = axis.cross(X_FT.linear().col(0));
  X_FT.translation() = Eigen::Vector3d(-0.66, -28.26, 250.33) - 250 * axis;
  problem.X_FT = X_FT;
  const Pose X_BT = ForwardFlange(problem.arm, paper.pose1) * X_FT;
  paper.point.position = X_BT.translation();
  paper.point.normal = paper.point.tool_axis = X_BT.linear().col(2);
  paper.point.feed = X_BT.linear().col(0);
  return paper;
}

}  // namespace millpose
