// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/spread.hpp"

#include "geometry/mesh/mesh.hpp"
#include "tests/toolpath/vault.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

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
  const Mesh mesh = SoundMesh(Vault(radius, 200, true));
  ToolpathOptions options;
  With<ParallelPlanes>(options).normal = Eigen::Vector3d::UnitZ();
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

}  // namespace
}  // namespace millpose
