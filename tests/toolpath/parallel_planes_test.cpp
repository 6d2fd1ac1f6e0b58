// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

TEST(ParallelPlanes, SupportPadIsCoveredInZigzag) {
  const Mesh mesh = SampleMesh("support_pad");
  const ToolpathOptions options = PadOptions();
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 10);
  ExpectSound(mesh, toolpath, options);
  for (int i = 0; i < 10; ++i) {
    const Pass& pass = toolpath.passes[i];
    ASSERT_EQ(pass.points.size(), 21);
    const double sign = i % 2 == 0 ? 1 : -1;
    for (int k = 0; k < 21; ++k) {
      const MillingPoint& point = pass.points[k];
      EXPECT_LT((point.position - Eigen::Vector3d(sign * (-40 + 4 * k), -36 + 8 * i, 0)).norm(), 1e-9);
      EXPECT_EQ(point.normal, Eigen::Vector3d::UnitZ());
      EXPECT_LT((point.feed - sign * Eigen::Vector3d::UnitX()).norm(), 1e-12);
    }
  }
}

TEST(ParallelPlanes, OneWayKeepsTheDirection) {
  ToolpathOptions options = PadOptions();
  options.direction = Direction::kOneWay;
  for (const Pass& pass : MakeToolpath(SampleMesh("support_pad"), options, {}).passes)
    EXPECT_NEAR(pass.points.front().position.x(), -40, 1e-9);
}

TEST(ParallelPlanes, RegionCutsExactly) {
  ToolpathOptions options = PadOptions();
  options.region.box = RegionBox{Eigen::Vector3d(-13.37, -100, -1), Eigen::Vector3d(21.1, 100, 1)};
  for (const Pass& pass : MakeToolpath(SampleMesh("support_pad"), options, {}).passes) {
    const auto [low, high] = std::minmax(pass.points.front().position.x(), pass.points.back().position.x());
    EXPECT_NEAR(low, -13.37, 2e-7);
    EXPECT_NEAR(high, 21.1, 2e-7);
    EXPECT_GE(low, -13.37 - 1e-9);
    EXPECT_LE(high, 21.1 + 1e-9);
  }
  options.region.box.reset();
  options.region.rim_distance = 7.25;
  const Toolpath inner = MakeToolpath(SampleMesh("support_pad"), options, {});
  EXPECT_EQ(inner.passes.size(), 9);  // 65.5 mm in steps of at most 8
  for (const Pass& pass : inner.passes) {
    EXPECT_NEAR(std::abs(pass.points.front().position.x()), 40 - 7.25, 2e-7);
    EXPECT_NEAR(std::abs(pass.points.back().position.x()), 40 - 7.25, 2e-7);
  }
}

TEST(ParallelPlanes, WindowAndPadsInterruptPasses) {
  const Mesh mesh = SampleMesh("cabin_panel");
  ToolpathOptions options;
  With<ParallelPlanes>(options);
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(30);
  options.region.rim_distance = 12;
  options.stepover = 20;
  options.spacing = 10;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ExpectSound(mesh, toolpath, options);
  EXPECT_GT(toolpath.passes.size(), 50);
  EXPECT_GE(PointsOf(toolpath), 2000);
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      // The normal is that of the cylinder: creases at pads and window are not averaged across.
      const Eigen::Vector3d radial =
          Eigen::Vector3d(0, point.position.y(), point.position.z() + 1500).normalized();
      ASSERT_LT(std::acos(std::min(1.0, point.normal.dot(radial))), DegToRad(0.4));  // half a facet, at rims
      const double s = 1500 * std::atan2(point.position.y(), point.position.z() + 1500);
      const bool in_window = point.position.x() > -110 && point.position.x() < 90 && std::abs(s) < 150;
      ASSERT_FALSE(in_window && std::abs(s) < 90) << point.position.transpose();
    }
  // Parts of an interrupted lane follow each other along the way of travel.
  for (size_t i = 0; i + 1 < toolpath.passes.size(); ++i) {
    const MillingPoint &end = toolpath.passes[i].points.back(), &next = toolpath.passes[i + 1].points.front();
    if (std::abs(end.position.x() - next.position.x()) > 1e-6) continue;
    EXPECT_GT((next.position - end.position).dot(end.feed), 0);
  }
}

TEST(ParallelPlanes, ClosedSlicesOfACylinderAreClosedPassesInOrder) {
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  ToolpathOptions options;
  With<ParallelPlanes>(options).normal = Eigen::Vector3d::UnitZ();
  options.stepover = 10;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 4);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(toolpath.passes[i].closed);
    EXPECT_NEAR(toolpath.passes[i].points[0].position.z(), 5 + 10.0 * static_cast<double>(i), 1e-9);
  }
  ExpectSound(mesh, toolpath, options);
}

TEST(ParallelPlanes, PassesEndAtCreases) {
  // Sliced along its axis the closed cylinder gives walls and caps as passes of their own.
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  ToolpathOptions options;
  With<ParallelPlanes>(options).normal = Eigen::Vector3d::UnitX();
  options.stepover = 200;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  EXPECT_EQ(toolpath.passes.size(), 4);
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points)
      EXPECT_LT((point.normal - pass.points[0].normal).norm(), 1e-12);
}

TEST(ParallelPlanes, WallsOfAThinSolidAreNotAveraged) {
  // A closed sheet of 0.5 mm: each point has the normal of its own side.
  const Mesh mesh = SoundMesh(BoxShape({0, 0, 0}, {100, 80, 0.5}));
  ToolpathOptions options;
  With<ParallelPlanes>(options);
  options.stepover = 10;
  options.normal_smoothing = 20;
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes)
    for (const MillingPoint& point : pass.points) EXPECT_NEAR(point.normal.cwiseAbs().maxCoeff(), 1, 1e-12);
}

}  // namespace
}  // namespace millpose
