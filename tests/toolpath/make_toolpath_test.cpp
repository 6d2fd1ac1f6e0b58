// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/make_toolpath.hpp"

#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"

namespace millpose {
namespace {

TEST(MakeToolpath, LeadLeansForwardAndTiltToTheRight) {
  ToolpathOptions options = PadOptions();
  options.lead = DegToRad(10);
  MillingPoint point = MakeToolpath(SampleMesh("support_pad"), options, {}).passes[0].points[3];
  EXPECT_LT((point.tool_axis - Eigen::Vector3d(std::sin(options.lead), 0, std::cos(options.lead))).norm(),
            1e-12);
  options.lead = 0;
  options.tilt = DegToRad(5);
  point = MakeToolpath(SampleMesh("support_pad"), options, {}).passes[0].points[3];
  EXPECT_LT((point.tool_axis - Eigen::Vector3d(0, -std::sin(options.tilt), std::cos(options.tilt))).norm(),
            1e-12);
}

TEST(MakeToolpath, TransformTurnsDirectionsToo) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translate(Eigen::Vector3d(1, 2, 3));
  X.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  const Toolpath a = MakeToolpath(SampleMesh("support_pad"), PadOptions(), {}), b = Transformed(a, X);
  const MillingPoint &p = a.passes[3].points[5], &q = b.passes[3].points[5];
  EXPECT_LT((q.position - X * p.position).norm(), 1e-12);
  EXPECT_LT((q.feed - X.linear() * p.feed).norm(), 1e-12);
  EXPECT_LT((q.tool_axis - X.linear() * p.tool_axis).norm(), 1e-12);
  EXPECT_LT((b.passes[3].rotation_reference - X.linear() * a.passes[3].rotation_reference).norm(), 1e-12);
}

TEST(MakeToolpath, LeaningCutterTouchesTheContactAndDoesNotGouge) {
  const Mesh mesh = SampleMesh("support_pad");
  ToolpathOptions options = PadOptions();
  options.lead = DegToRad(5);
  options.cutter = CutterShape{10, 2, 40};
  options.ends.overrun = 12;
  options.layers = {2, 1, 0};
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 20);
  const Pass& pass = toolpath.passes[10];
  EXPECT_EQ(pass.points.front().kind, PointKind::kLeadIn);
  for (const MillingPoint& point : pass.points) {
    EXPECT_EQ(DeepestGouge(mesh, options.cutter, point.position, point.tool_axis, 1e-6).depth, 0);
    const Gouge pushed =
        DeepestGouge(mesh, options.cutter, point.position - 0.1 * point.tool_axis, point.tool_axis, 1e-6);
    EXPECT_NEAR(pushed.depth, point.kind == PointKind::kCut ? 0.1 : pushed.depth, 1e-3);
  }
}

TEST(MakeToolpath, ClimbHasTheUnmilledMaterialOnTheRight) {
  const Mesh mesh = SampleMesh("support_pad");
  for (const char* strategy : {"parallel_planes", "contours"})
    for (const bool climb : {true, false}) {
      ToolpathOptions options = PadOptions();
      Choose(options, strategy);
      options.direction = climb ? Direction::kClimb : Direction::kConventional;
      const Toolpath toolpath = MakeToolpath(mesh, options, {});
      for (size_t i = 0; i + 1 < toolpath.passes.size(); ++i)
        for (const MillingPoint& point : toolpath.passes[i].points) {
          const Eigen::Vector3d right = point.feed.cross(point.normal);
          // The next pass lies on the unmilled side.
          const Toolpath next{{toolpath.passes[i + 1]}, {}};
          const double ahead =
              DistanceFromPath(next, point.position + right) - DistanceFromPath(next, point.position - right);
          if (std::abs(ahead) > 0.5) {
            EXPECT_EQ(ahead < 0, climb) << strategy;
          }
        }
    }
  ToolpathOptions options = PadOptions();
  With<CurveStrategy>(options);
  With<CurveStrategy>(options).points = {{-30, 0, 0}, {30, 0, 0}};
  options.direction = Direction::kClimb;
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
}

TEST(MakeToolpath, OrderByTravelIsAPermutationWithShorterWays) {
  const Mesh mesh = SampleMesh("cabin_panel");
  ToolpathOptions options;
  With<ParallelPlanes>(options);
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(30);
  options.region.rim_distance = 12;
  options.stepover = 20;
  options.spacing = 10;
  const auto travel = [](const Toolpath& toolpath) {
    double sum = 0;
    for (size_t i = 1; i < toolpath.passes.size(); ++i)
      sum +=
          (toolpath.passes[i].points.front().position - toolpath.passes[i - 1].points.back().position).norm();
    return sum;
  };
  const Toolpath laid = MakeToolpath(mesh, options, {});
  options.order_by_travel = true;
  const Toolpath ordered = MakeToolpath(mesh, options, {});
  ASSERT_EQ(ordered.passes.size(), laid.passes.size());
  EXPECT_EQ(PointsOf(ordered), PointsOf(laid));
  EXPECT_LT(travel(ordered), 0.8 * travel(laid));
  ExpectSound(mesh, ordered, options);
}

TEST(MakeToolpath, SaysWhatIsWrong) {
  const Mesh mesh = SampleMesh("support_pad");
  ToolpathOptions options = PadOptions();
  options.stepover = 0;
  options.spacing = -1;
  try {
    MakeToolpath(mesh, options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 2);
  }
  options = PadOptions();
  With<Rings>(options).axis_direction *= 2;
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
  options.strategy = nullptr;
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
  options = PadOptions();
  options.region.facing = Eigen::Vector3d(1, 1, 1).normalized();
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(MakeToolpath(mesh, PadOptions(), source.get_token()), Interrupted);
}

}  // namespace
}  // namespace millpose
