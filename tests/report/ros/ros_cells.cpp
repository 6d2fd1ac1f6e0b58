// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/ros/ros_cells.hpp"

#include <filesystem>

#include "job/assemble.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace fs = std::filesystem;
using Eigen::Vector3d;

Pose RandomPose(RandomStream& random, double reach) {
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1),
                                  random.Uniform(-1, 1))
                   .normalized()
                   .toRotationMatrix();
  for (double& value : X.translation()) value = random.Uniform(-reach, reach);
  return X;
}

Cell WithEverything(Cell cell, RandomStream& random) {
  cell.X_WP = RandomPose(random, 3000);
  const Triangles wedge{{{0, 0, 0}, {700, 0, 0}, {0, 500, 0}, {0, 0, 300}},
                        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  Triangles far = wedge;  // as parts of aircraft are given: far from their origin
  for (Vector3d& p : far.vertices) p += Vector3d(31234.567, -8000, 2500);
  const std::vector<Shape> shapes{Box{{100, 200, 300}},   Sphere{120},    Cylinder{80, 250},
                                  Capsule{60, 200},       Capsule{60, 0}, Cone{90, 40, 70},
                                  Convex{wedge.vertices}, wedge,          far};
  std::vector<Body> mounts;
  const auto add = [&](Mount mount, int link, int axis) {
    Body& body = mounts.emplace_back();
    body.mount = mount, body.link = link, body.axis = axis;
  };
  for (const Mount mount : {Mount::kWorld, Mount::kTool, Mount::kWorkpiece}) add(mount, 0, 0);
  for (int link = 0; link <= 6; ++link) add(Mount::kLink, link, 0);
  for (size_t axis = 0; axis < cell.external_axes.size(); ++axis)
    add(Mount::kCarriage, 0, static_cast<int>(axis));
  for (size_t i = 0; i < mounts.size(); ++i)
    for (size_t k = 0; k < shapes.size(); ++k) {
      Body body = mounts[i];
      body.name = fmt::format("added {}/{}", i, k);
      body.X_MG = RandomPose(random, 800);
      body.shape = shapes[k];
      cell.bodies.push_back(body);
    }
  return cell;
}

std::vector<NamedCell> AllCells() {
  std::vector<NamedCell> cells;
  for (const auto& entry : fs::directory_iterator(fs::path(SourceDir()) / "cells")) {
    if (entry.path().extension() != ".yaml") continue;
    std::map<std::string, std::string> bytes;
    cells.push_back({entry.path().stem(), MakeCell(LoadCell(entry.path(), &bytes), bytes)});
  }
  std::ranges::sort(cells, {}, &NamedCell::name);
  // What no shipped cell has: an arm with all lengths and offsets, one rotary axis on another, names alike.
  RandomStream random(8, 1);
  Cell odd = cells.front().cell;
  odd.arm = OddArm();
  odd.arm.speed.setConstant(1);
  odd.X_WB = RandomPose(random, 900);
  const auto add = [&](const char* name, AxisKind kind, Carries carries, const Vector3d& direction) {
    ExternalAxis& axis = odd.external_axes.emplace_back();
    axis.name = name, axis.kind = kind, axis.carries = carries, axis.direction = direction;
    for (double& value : axis.origin) value = random.Uniform(-2000, 2000);
    axis.upper = kind == AxisKind::kLinear ? 900 : 2;
    axis.lower = -axis.upper, axis.speed = 1;
  };
  add("E 1", AxisKind::kLinear, Carries::kRobot, Vector3d(1, 2, 2) / 3);
  add("joint_1", AxisKind::kRotary, Carries::kWorkpiece, Vector3d(0, 0.6, 0.8));
  add("E 1", AxisKind::kRotary, Carries::kWorkpiece, Vector3d(0.6, -0.8, 0));
  cells.push_back({"odd", std::move(odd)});
  return cells;
}

}  // namespace millpose
