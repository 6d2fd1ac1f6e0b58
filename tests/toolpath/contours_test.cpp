// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
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

/// The passes of a line from x = −30 to 30 mm at y = 5, looked at along `looking`.
std::vector<Pass> Projected(const Triangles& part, const Eigen::Vector3d& looking) {
  ToolpathOptions options;
  options.cutter.radius = 1;
  With<CurveStrategy>(options).points = {{-30, 5, 0}, {30, 5, 0}};
  With<CurveStrategy>(options).project_along = looking;
  return MakeToolpath(Mesh(part), options, {}).passes;
}

TEST(Curve, GoesOntoTheFirstFaceMet) {
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const Triangles block = BoxShape({-50, -50, -20}, {50, 50, 0});
  for (const Eigen::Vector3d& looking : {down, Eigen::Vector3d(-down)}) {
    const std::vector<Pass> passes = Projected(block, looking);
    ASSERT_EQ(passes.size(), 1u);
    for (const MillingPoint& point : passes[0].points) {
      EXPECT_NEAR(point.position.z(), looking.z() < 0 ? 0 : -20, 1e-9);
      EXPECT_LT(point.normal.dot(looking), -0.999);
    }
  }
  // A smaller block hovers over the right half: from above the line changes over, from below it does not.
  Triangles two = block;
  Append(two, BoxShape({10, -50, 30}, {50, 50, 40}));
  const std::vector<Pass> above = Projected(two, down), below = Projected(two, -down);
  ASSERT_EQ(above.size(), 2u);
  EXPECT_NEAR(above[0].points.back().position.x(), 10, 1e-6);
  EXPECT_NEAR(above[0].points.back().position.z(), 0, 1e-9);
  EXPECT_NEAR(above[1].points.front().position.z(), 40, 1e-9);
  EXPECT_NEAR(above[1].points.back().position.x(), 30, 1e-6);
  ASSERT_EQ(below.size(), 1u);
}

TEST(Curve, AnOpenSheetIsNotMilledFromBehind) {
  Triangles sheet;
  sheet.vertices = {{-50, -50, 3}, {50, -50, 3}, {50, 50, 3}, {-50, 50, 3}};
  sheet.faces = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(Projected(sheet, -Eigen::Vector3d::UnitZ()).size(), 1u);
  try {
    Projected(sheet, Eigen::Vector3d::UnitZ());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("give the opposite direction"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace millpose
