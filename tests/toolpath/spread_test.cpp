// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/spread.hpp"

#include "surface/mesh.hpp"
#include "tests/surface/shapes.hpp"
#include "toolpath/make_toolpath.hpp"

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
  const std::vector<double> positions = SpreadOnSurface(stretches, 0, 20, 10);
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

TEST(Spread, ScallopHeightAgreesWithRemovedMaterial) {
  for (const double height : {0.005, 0.02, 0.1}) {
    const double radius = 8, stepover = StepoverForScallop(radius, height);
    // What two neighbouring balls on a flat leave standing, sampled finely.
    double left = 0;
    for (int i = 0; i <= 10000; ++i) {
      const double x = stepover * i / 10000;
      const auto ball = [&](double centre) {
        return radius - std::sqrt(radius * radius - (x - centre) * (x - centre));
      };
      left = std::max(left, std::min(ball(0), ball(stepover)));
    }
    EXPECT_NEAR(left, height, height * 0.001);
  }
}

}  // namespace
}  // namespace millpose
