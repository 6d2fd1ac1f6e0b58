// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cutter.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/surface/shapes.hpp"

namespace millpose {
namespace {

const std::array<CutterShape, 3> kCutters{{{10, 0, 40}, {10, 10, 40}, {10, 3, 40}}};

Eigen::Vector3d Leaning(double lead, double tilt) {
  return Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(lead, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
}

TEST(Cutter, TouchesThePlaneAtTheContactAndNowhereElse) {
  for (const CutterShape& cutter : kCutters)
    for (const double lead : {0.0, 0.1, -0.4})
      for (const double tilt : {0.0, 0.3}) {
        const Eigen::Vector3d axis = Leaning(lead, tilt), contact(3, -7, 0);
        const Eigen::Vector3d tip = TipAtContact(cutter, contact, Eigen::Vector3d::UnitZ(), axis);
        // The cutter's surface, sampled: nothing below the plane, the lowest point at the contact.
        const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
        double lowest = 1e9;
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int i = 0; i <= 400; ++i)
          for (int j = 0; j < 720; ++j) {
            const double rho = cutter.radius * i / 400, phi = 2 * kPi * j / 720;
            const Eigen::Vector3d p =
                tip + rho * (std::cos(phi) * u + std::sin(phi) * v) + cutter.Bottom(rho) * axis;
            if (p.z() < lowest - 1e-9) {
              lowest = p.z();
              place = p;
            }
          }
        EXPECT_NEAR(lowest, 0, 1e-3);
        if (lead != 0 || tilt != 0) {
          EXPECT_LT((place - contact).norm(), 0.2) << place.transpose();
        }
      }
}

TEST(Cutter, GougesAgreeWithBruteForce) {
  RandomStream random(17, 0);
  int gouges = 0;
  for (int i = 0; i < 150; ++i) {
    Triangles one;
    for (int k = 0; k < 3; ++k)
      one.vertices.emplace_back(random.Uniform(-20, 20), random.Uniform(-20, 20), random.Uniform(-8, 6));
    one.faces = {{0, 1, 2}};
    const Mesh mesh = SoundMesh(one);
    const CutterShape& cutter = kCutters[i % 3];
    const Eigen::Vector3d axis = Leaning(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3));
    double brute = 0;
    const int n = 300;
    for (int u = 0; u <= n; ++u)
      for (int v = 0; u + v <= n; ++v) {
        const Eigen::Vector3d p = one.vertices[0] + (one.vertices[1] - one.vertices[0]) * u / n +
                                  (one.vertices[2] - one.vertices[0]) * v / n;
        const double z = p.dot(axis), rho = (p - z * axis).norm();
        if (rho <= cutter.radius) brute = std::max(brute, z - cutter.Bottom(rho));
      }
    const Gouge gouge = DeepestGouge(mesh, cutter, Eigen::Vector3d::Zero(), axis, 0.001);
    EXPECT_GE(gouge.depth, brute - 0.002) << i;
    EXPECT_LE(gouge.depth, brute + 0.35) << i;  // the grid misses up to a cell near the cutter's side
    gouges += brute > 0.01 ? 1 : 0;
  }
  EXPECT_GT(gouges, 40);
}

TEST(Cutter, LyingOnTheSurfaceIsNoGouge) {
  const Mesh mesh = SoundMesh(GridShape(10, 10, 10));
  for (const CutterShape& cutter : kCutters) {
    const Eigen::Vector3d axis = Leaning(0.05, 0.02);
    const Eigen::Vector3d tip = TipAtContact(cutter, {50, 50, 0}, Eigen::Vector3d::UnitZ(), axis);
    EXPECT_EQ(DeepestGouge(mesh, cutter, tip, axis, 1e-6).depth, 0);
    const Gouge gouge = DeepestGouge(mesh, cutter, tip - 0.5 * axis, axis, 1e-6);
    EXPECT_NEAR(gouge.depth, 0.5, 1e-3);
    EXPECT_GE(gouge.face, 0);
  }
}

}  // namespace
}  // namespace millpose
