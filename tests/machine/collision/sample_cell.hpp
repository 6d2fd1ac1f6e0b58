// SPDX-License-Identifier: GPL-3.0-or-later
// Cells for the tests: an arm with the lengths of a KR 500 R2830, with plain links and a spindle at a right
// angle, or with nothing but the bodies that a test asks for.
#pragma once

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/collision/cell.hpp"

namespace millpose::test {

inline Arm SampleArm() {
  Arm arm;
  arm.name = "sample";
  arm.d1 = 1045, arm.a1 = 500, arm.a2 = 1300, arm.d4 = 1025, arm.dz = -55, arm.d6 = 290;
  arm.sign = {-1, 1, 1, -1, 1, -1};
  arm.lower << -185, -130, -100, -350, -120, -350;
  arm.upper << 185, 20, 144, 350, 120, 350;
  arm.speed << 80, 75, 70, 70.5, 70.5, 109.7;
  arm.acceleration << 200, 200, 200, 300, 300, 500;
  for (Joints* angles : {&arm.lower, &arm.upper, &arm.speed, &arm.acceleration}) *angles *= kRadPerDeg;
  return arm;
}

inline Pose At(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }
inline Pose AlongX(double x, double y, double z) {
  return At(x, y, z) * Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitY());
}

inline Joints Degrees(double a1, double a2, double a3, double a4, double a5, double a6) {
  Joints q;
  q << a1, a2, a3, a4, a5, a6;
  return q * kRadPerDeg;
}

inline Joints HomePose() { return Degrees(0, -90, 90, 0, 0, 0); }

/// The arm and its tool frame, without any body.
inline Cell EmptyCell() {
  Cell cell;
  cell.name = "sample";
  cell.arm = SampleArm();
  cell.X_FT.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;  // T's z = F's x, T's x = F's z
  cell.X_FT.translation() << -250, 0, 250;
  cell.cutter_length = 40;
  cell.home = HomePose();
  return cell;
}

/// Links, bracket, tool stack and a platform.
inline Cell SampleCell() {
  Cell cell = EmptyCell();
  const auto link = [&](std::string name, int index, const Pose& X, Shape shape) {
    cell.bodies.push_back({std::move(name), BodyClass::kLink, Mount::kLink, index, X, std::move(shape)});
  };
  link("base", 0, At(0, 0, 291), Cylinder{527, 582});
  link("link1", 1, At(145, -153, -60), Box{{1210, 927, 380}});
  link("link2", 2, At(650, -300, 0), Box{{1300, 400, 420}});
  link("link3", 3, At(0, 100, 40), Box{{742, 705, 726}});
  link("forearm", 4, AlongX(-300, 0, 0), Cylinder{155, 600});
  link("link5", 5, At(49, 0, 0), Box{{400, 300, 300}});
  link("flange", 6, At(0, 0, -27), Cylinder{126, 54});
  cell.bodies.push_back(
      {"bracket", BodyClass::kSpindle, Mount::kLink, 6, At(30, 0, 100), Box{{200, 200, 200}}});
  const auto tool = [&](std::string name, BodyClass c, double z, Shape shape) {
    cell.bodies.push_back({std::move(name), c, Mount::kTool, 0, At(0, 0, z), std::move(shape)});
  };
  tool("cutter", BodyClass::kCutter, 30, Cylinder{10, 60});
  tool("holder", BodyClass::kHolder, 90, Cone{20, 31.5, 60});
  tool("spindle", BodyClass::kSpindle, 280, Cylinder{80, 320});
  cell.bodies.push_back(
      {"platform", BodyClass::kPlatform, Mount::kWorld, 0, At(0, 0, -200), Box{{2000, 1600, 400}}});
  return cell;
}

/// A closed box as a mesh, centred, faces counter-clockwise from outside.
inline Triangles BoxMesh(const Eigen::Vector3d& size) {
  Triangles mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        Eigen::Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5).cwiseProduct(size));
  }
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline Pose RandomPose(RandomStream& random, double reach) {
  Eigen::Quaterniond rotation{random.Normal(), random.Normal(), random.Normal(), random.Normal()};
  const Eigen::Vector3d place{random.Uniform(-reach, reach), random.Uniform(-reach, reach),
                              random.Uniform(-reach, reach)};
  Pose X = At(place.x(), place.y(), place.z());
  X.linear() = rotation.normalized().toRotationMatrix();
  return X;
}

inline Joints RandomJoints(RandomStream& random, const Arm& arm) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = random.Uniform(arm.lower[i], arm.upper[i]);
  return q;
}

}  // namespace millpose::test
