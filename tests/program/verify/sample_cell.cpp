// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/verify/sample_cell.hpp"

#include "base/rotation.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

Body ToolPart(const std::string& name, BodyClass body_class, double from, double length, double diameter) {
  Body body;
  body.name = name;
  body.body_class = body_class;
  body.mount = Mount::kTool;
  body.X_MG.translation().z() = from + length / 2;
  body.shape = Cylinder{diameter / 2, length};
  return body;
}

/// A long wall along the rail, a drum on the table.
void StandOnAxes(const PlanResult& plan, Cell& cell) {
  cell.external_axes = plan.external_axes;
  Body& part = cell.bodies.back();
  part.shape = Box{{300, 1500, 20}};
  if (plan.external_axes.back().name != "table") return;
  part.shape = Cylinder{400, 300};
  part.X_MG.translation() = Eigen::Vector3d(0, 0, -400);
  part.X_MG.linear() = RotationAbout(Eigen::Vector3d::UnitY(), kPi / 2);
}

}  // namespace

Cell SampleCell(const PlanResult& plan) {
  Cell cell;
  cell.name = plan.cell;
  cell.arm = plan.arm;
  cell.X_WB = plan.X_WB;
  cell.X_FT = plan.X_FT;
  cell.X_WP = plan.X_WP;
  cell.cutter_length = 40;
  cell.home = plan.home;
  cell.bodies = {ToolPart("cutter", BodyClass::kCutter, 0, 60, 20),
                 ToolPart("holder", BodyClass::kHolder, 60, 60, 63),
                 ToolPart("spindle", BodyClass::kSpindle, 120, 200, 160)};
  Body wall;
  wall.name = "wall";
  wall.body_class = BodyClass::kWorkpiece;
  wall.mount = Mount::kWorkpiece;
  wall.X_MG.translation().z() = -10;
  wall.shape = Box{{300, 300, 20}};
  cell.bodies.push_back(wall);
  if (!plan.external_axes.empty()) StandOnAxes(plan, cell);
  return cell;
}

VerifyOptions SampleOptions(const PlanResult& plan) {
  VerifyOptions options;
  options.lower = plan.arm.lower;
  options.upper = plan.arm.upper;
  options.max_corner = 0.05;  // as SampleSettings() have it
  return options;
}

}  // namespace millpose
