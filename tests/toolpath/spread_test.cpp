// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/spread.hpp"

#include "surface/mesh.hpp"
#include "tests/surface/shapes.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/scallop.hpp"

namespace millpose {
namespace {

// A quarter of a cylinder's wall about y, facing up, `rows` facets from 10° to 80° of its slope.
Triangles Vault(double radius, int rows) {
  Triangles mesh;
  for (int i = 0; i <= rows; ++i)
    for (const double y : {0.0, 100.0}) {
      const double angle = DegToRad(10 + 70.0 * i / rows);
      mesh.vertices.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
    }
  for (int i = 0; i < rows; ++i) {
    mesh.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    mesh.faces.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

TEST(Spread, EvenKeepsTheStepover) {
  const std::vector<double> expected{5, 15, 25};
  EXPECT_EQ(SpreadEvenly(0, 30, 10), expected);
  EXPECT_EQ(SpreadEvenly(0, 30.1, 10).size(), 4);
  EXPECT_EQ(SpreadEvenly(0, 0, 10).size(), 1);
}

TEST(Spread, OnSurfaceFollowsTheSteepestStretch) {
  // 10 mm of slope 1, then 10 mm of slope 3 beside a flatter one: 40 mm of way in steps of 10.
  const std::vector<Stretch> stretches{{0, 10, 1}, {10, 20, 3}, {12, 20, 2}};
  std::vector<Stretch> dense = stretches;
  for (Stretch& stretch : dense) stretch.density /= 10;
  const PassScale scale(dense, 0, 20);
  const std::vector<double> positions = scale.Positions();
  ASSERT_EQ(positions.size(), 4);
  EXPECT_NEAR(positions[0], 5, 1e-12);
  EXPECT_NEAR(positions[1], 10 + 5.0 / 3, 1e-12);
  EXPECT_NEAR(positions[3], 20 - 5.0 / 3, 1e-12);
}

TEST(Spread, StepoverOnASingleCurvedSurfaceIsTheWantedOne) {
  const double radius = 300, wanted = 7;
  const Mesh mesh = SoundMesh(Vault(radius, 200));
  ToolpathOptions options;
  options.plane_normal = Eigen::Vector3d::UnitZ();
  options.stepover = wanted;
  options.stepover_on_surface = true;
  std::vector<double> angles, steps;
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes)
    angles.push_back(std::atan2(pass.points[0].position.z(), pass.points[0].position.x()));
  for (size_t i = 1; i < angles.size(); ++i) steps.push_back(radius * (angles[i] - angles[i - 1]));
  ASSERT_GT(steps.size(), 40);
  std::ranges::sort(steps);
  EXPECT_LE(steps.back(), wanted * 1.01);
  EXPECT_NEAR(steps[steps.size() / 2], wanted, wanted * 0.02);
  EXPECT_GT(steps.front(), wanted * 0.9);
}

TEST(Spread, PassesAndPositionsAreInverse) {
  const PassScale scale({{0, 10, 0.1}, {10, 20, 0.3}}, 0, 20);
  ASSERT_EQ(scale.count(), 4);
  for (const double passes : {0.3, 1.0, 2.7, 3.9})
    EXPECT_NEAR(scale.PassesAt(scale.PositionAt(passes)), passes, 1e-12);
}

// What passes over a vault leave standing, sampled finely: the greatest distance from the surface of what no
// cutter has removed, over the middle of the vault, by the cutter's outline alone.
double LeftStanding(const Toolpath& toolpath, const CutterShape& cutter, double radius) {
  std::vector<Eigen::Vector2d> tips;  // x, z
  std::vector<Eigen::Vector2d> axes;
  for (const Pass& pass : toolpath.passes) {
    const MillingPoint& point = pass.points[pass.points.size() / 2];
    tips.emplace_back(point.position.x(), point.position.z());
    axes.emplace_back(point.tool_axis.x(), point.tool_axis.z());
  }
  const double r = cutter.corner_radius, a = cutter.radius - r;
  double left = 0;
  for (int i = 0; i <= 4000; ++i) {
    const double angle = DegToRad(30 + 40.0 * i / 4000);
    const Eigen::Vector2d up(std::cos(angle), std::sin(angle));
    double lowest = 1e9;
    for (size_t k = 0; k < tips.size(); ++k) {
      if ((tips[k] - radius * up).norm() > 2 * cutter.radius) continue;
      // The lowest height at which the ray from the surface outwards is in the outline.
      const auto inside = [&](double height) {
        const Eigen::Vector2d d = (radius + height) * up - tips[k];
        const double z = d.dot(axes[k]), x = std::abs(d.x() * axes[k].y() - d.y() * axes[k].x());
        if (x > cutter.radius) return false;
        const double beyond = std::max(0.0, x - a);
        return z >= r - std::sqrt(r * r - beyond * beyond);
      };
      double low = -0.01, high = 2;
      if (!inside(high)) continue;
      for (int step = 0; step < 40; ++step) {
        const double middle = (low + high) / 2;
        (inside(middle) ? high : low) = middle;
      }
      lowest = std::min(lowest, high);
    }
    left = std::max(left, lowest);
  }
  return left;
}

TEST(Spread, ScallopsAreAsHighAsWanted) {
  const double radius = 200;
  const Mesh mesh = SoundMesh(Vault(radius, 700));
  for (const CutterShape& cutter : {CutterShape{8, 8, 30}, CutterShape{8, 2, 30}, CutterShape{8, 0, 30}})
    for (const double wanted : {0.02, 0.1}) {
      ToolpathOptions options;
      options.plane_normal = Eigen::Vector3d::UnitZ();
      options.stepover = 16;
      options.scallop = wanted;
      options.cutter = cutter;
      const double left = LeftStanding(MakeToolpath(mesh, options, {}), cutter, radius);
      EXPECT_LE(left, 1.05 * wanted) << cutter.corner_radius;
      EXPECT_GE(left, 0.9 * wanted) << cutter.corner_radius;  // the number of passes is rounded up
    }
}

TEST(Scallops, AgreeWithTheFormulas) {
  // Ball of radius R on a flat: s = 2 √(2 R h − h²).
  const double height = 0.05;
  EXPECT_NEAR(Scallops({8, 8, 30}, 0, 0).Stepover(height, 0), 2 * std::sqrt(2 * 8 * height - height * height),
              1e-6);
  // Ball over convex and concave cylinders of radius ρ: the law of cosines in the triangle of axis, centre,
  // cusp.
  for (const double rho : {100.0, -100.0}) {
    const double cosine =
        (std::pow(rho + 8, 2) + std::pow(rho + height, 2) - 64) / (2 * (rho + 8) * (rho + height));
    EXPECT_NEAR(Scallops({8, 8, 30}, 0, 0).Stepover(height, 1 / rho), 2 * std::abs(rho) * std::acos(cosine),
                1e-5);
  }
  // A flat cutter leaves nothing on a flat while its discs meet; on a convex cylinder s = 2 ρ acos(ρ ÷ (ρ +
  // h)).
  EXPECT_NEAR(Scallops({8, 0, 30}, 0, 0).Stepover(height, 0), 16, 1e-6);
  EXPECT_NEAR(Scallops({8, 0, 30}, 0, 0).Stepover(height, 1 / 100.0), 200 * std::acos(100 / (100 + height)),
              1e-5);
  // Leaning forward, its outline is an ellipse with half-axes R and R sin(lead): s = 2 R √(1 − (1 − h ÷ b)²).
  const double b = 8 * std::sin(0.1);
  EXPECT_NEAR(Scallops({8, 0, 30}, 0.1, 0).Stepover(height, 0),
              16 * std::sqrt(1 - std::pow(1 - height / b, 2)), 1e-5);
}

}  // namespace
}  // namespace millpose
