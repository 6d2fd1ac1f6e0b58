// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "tests/surface/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

TEST(Contours, ContoursKeepTheirDistanceFromTheRims) {
  const Mesh mesh = SampleMesh("support_pad");
  ToolpathOptions options = PadOptions();
  Choose(options, "contours");
  options.region.rim_distance = 4;
  options.stepover = 6;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 6);  // 36 mm from the rim's distance to the middle
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(toolpath.passes[i].closed);
    const double wanted = 4 + 6 * (static_cast<double>(i) + 0.5);
    for (const MillingPoint& point : toolpath.passes[i].points) {
      EXPECT_LT(mesh.Closest(point.position).distance, 1e-6);
      const double distance = 40 - point.position.head<2>().cwiseAbs().maxCoeff();
      EXPECT_NEAR(distance, wanted, 0.02);
      EXPECT_GT(Eigen::Vector3d::UnitZ().cross(point.position).dot(point.feed), 0);  // counter-clockwise
    }
  }
}

TEST(Contours, ContoursGoRoundIslands) {
  const Mesh mesh = SampleMesh("cabin_panel");
  ToolpathOptions options;
  Choose(options, "contours");
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(30);
  options.stepover = 25;
  const Region region(mesh, options.region);
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ExpectSound(mesh, toolpath, options);
  EXPECT_GT(toolpath.passes.size(), 8);
  // On its level everywhere, at the corners too.
  const double largest = 25.0 * 20;
  for (const Pass& pass : toolpath.passes) {
    std::vector<double> distances;
    for (const MillingPoint& point : pass.points) distances.push_back(region.BorderDistance(point.position));
    const auto [low, high] = std::ranges::minmax(distances);
    EXPECT_LT(high - low, 0.03);
    EXPECT_LT(high, largest);
  }
}

TEST(Contours, SingleCurveIsProjectedOntoThePart) {
  const Mesh mesh = SampleMesh("cabin_panel");
  ToolpathOptions options;
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(60);
  const std::vector<Eigen::Vector3d> line{{-280, -400, 99}, {-100, -390, 50}, {-100, -200, 0}};
  With<CurveStrategy>(options).points = line;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  ExpectSound(mesh, toolpath, options);
  const auto& points = toolpath.passes[0].points;
  EXPECT_LT((points.front().position - line.front()).head<2>().norm(), 1e-6);
  EXPECT_LT((points.back().position - line.back()).head<2>().norm(), 1e-6);
  double nearest = 1e9;
  for (const MillingPoint& point : points) {
    nearest = std::min(nearest, (point.position - line[1]).head<2>().norm());
    EXPECT_NEAR(std::hypot(point.position.y(), point.position.z() + 1500), 1500, 0.1);
  }
  EXPECT_LT(nearest, 1e-6);
}

}  // namespace
}  // namespace millpose
