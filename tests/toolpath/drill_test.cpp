// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "base/random.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/pass_variants.hpp"
#include "toolpath/strategies/drill_holes.hpp"

namespace millpose {
namespace {

const CutterShape kDrill{3, 0, 40};
constexpr double kPlunge = 2, kRetract = 50;  // mm/s

ToolpathOptions Drilling(const Drill& drill) {
  ToolpathOptions options;
  options.strategy = std::make_shared<Drill>(drill);
  options.cutter = kDrill;
  options.feed_rate = 10;
  options.plunge_feed = kPlunge;
  options.retract_feed = kRetract;
  return options;
}

Drill OneHole(double depth) {
  Drill drill;
  drill.holes = {{{10, 20, 5}, Eigen::Vector3d(1, 2, 2) / 3, depth}};
  return drill;
}

Mesh None() { return Mesh(Triangles{}); }

double HeightOf(const MillingPoint& point, const HolePlace& hole) {
  return hole.axis.dot(point.position - hole.entrance);
}

// A block of 60 × 60 × 20 mm, its top at z = 0, with a hole of radius 3 down through it at the origin.
Mesh Bored() { return SoundMesh(LatheShape({{3, -20}, {30, -20}, {30, 0}, {3, 0}, {3, -20}}, 48)); }

Drill Circles(std::optional<Eigen::Vector3d> from = Eigen::Vector3d::UnitZ()) {
  Drill drill;
  drill.circles = {6, 0.05, from};
  drill.breakthrough = 1;
  return drill;
}

TEST(Drill, MaterialIsMetAtThePlungeFeedAndByNoMoreThanAPeck) {
  RandomStream random(1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    Drill drill = OneHole(random.Uniform(0.5, 30));
    drill.point_angle = DegToRad(random.Uniform(60, 180));
    if (trial % 3 > 0) drill.peck = random.Uniform(0.2, 8);
    if (trial % 3 > 1) drill.chip_retract = random.Uniform(0.05, *drill.peck);
    ToolpathOptions options = Drilling(drill);
    options.spacing = random.Uniform(0.3, 7);
    const Toolpath toolpath = MakeToolpath(None(), options, {});
    ASSERT_EQ(toolpath.passes.size(), 1);
    const std::vector<MillingPoint>& points = toolpath.passes[0].points;
    EXPECT_TRUE(toolpath.passes[0].whole);
    EXPECT_NEAR(HeightOf(points.front(), drill.holes[0]), drill.clearance, 1e-9);
    EXPECT_NEAR(HeightOf(points.back(), drill.holes[0]), drill.clearance, 1e-9);
    double done = 0, stroke = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const double from = HeightOf(points[i - 1], drill.holes[0]), to = HeightOf(points[i], drill.holes[0]);
      EXPECT_LE(std::abs(to - from), options.spacing + 1e-9);
      EXPECT_NEAR((points[i].position - points[i - 1].position).norm(),
                  points[i].arc_length - points[i - 1].arc_length, 1e-9);
      const Eigen::Vector3d off = points[i].position - drill.holes[0].entrance - to * drill.holes[0].axis;
      EXPECT_LT(off.norm(), 1e-9);
      if (to > from) stroke = 0;
      if (to >= done - 1e-9) continue;
      EXPECT_EQ(points[i].feed_rate, kPlunge);
      stroke += done - to;
      done = to;
      if (drill.peck) {
        EXPECT_LE(stroke, *drill.peck + 1e-9);
      }
    }
    const double tip = 3 / std::tan(drill.point_angle / 2);
    EXPECT_NEAR(-done, *drill.holes[0].depth + tip, 1e-9) << trial;
  }
}

TEST(Drill, PecksLeaveTheHoleUnlessTheyBreakChips) {
  for (const bool chips : {false, true}) {
    Drill drill = OneHole(12);
    drill.peck = 4;
    if (chips) drill.chip_retract = 0.5;
    double highest = -1e9;
    const Toolpath toolpath = MakeToolpath(None(), Drilling(drill), {});
    bool deep = false;
    for (const MillingPoint& point : toolpath.passes[0].points) {
      deep = deep || HeightOf(point, drill.holes[0]) < -3.9;
      if (deep && point.kind == PointKind::kCut) highest = std::max(highest, HeightOf(point, drill.holes[0]));
    }
    EXPECT_NEAR(highest, chips ? -3.5 : drill.clearance, 1e-9);
  }
}

TEST(Drill, HolesOfThePartAreAsDeepAsTheirWalls) {
  for (const double side : {1.0, -1.0}) {
    Drill drill = Circles(side * Eigen::Vector3d::UnitZ());
    drill.point_angle = DegToRad(90);
    const Toolpath toolpath = MakeToolpath(Bored(), Drilling(drill), {});
    ASSERT_EQ(toolpath.passes.size(), 1);
    double lowest = 1e9;
    for (const MillingPoint& point : toolpath.passes[0].points) {
      EXPECT_LT(point.position.head<2>().norm(), 1e-9);
      EXPECT_LT((point.tool_axis - side * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
      lowest = std::min(lowest, side * point.position.z());
    }
    // The far face, 1 mm of full diameter beyond it, and a point as long as the radius.
    EXPECT_NEAR(lowest, (side > 0 ? -20 : 0) - 1 - 3, 1e-9);
  }
}

TEST(Drill, ACountersinkReachesItsDiameterAtTheEntrance) {
  Drill drill = Circles();
  drill.breakthrough.reset();
  drill.point_angle = DegToRad(100);
  drill.countersink = {10.0, {}};
  double lowest = 0;
  const Toolpath toolpath = MakeToolpath(Bored(), Drilling(drill), {});
  for (const MillingPoint& point : toolpath.passes[0].points) lowest = std::min(lowest, point.position.z());
  EXPECT_NEAR(-lowest * std::tan(DegToRad(50)), 5, 1e-9);
}

TEST(Drill, WhatIsNotStatedIsAskedFor) {
  Drill drill = Circles(std::nullopt);
  EXPECT_NE(PathRefusal(Bored(), Drilling(drill)).find("from: missing"), std::string::npos);
  drill = Circles();
  drill.breakthrough.reset();
  EXPECT_NE(PathRefusal(Bored(), Drilling(drill)).find("breakthrough_mm: missing"), std::string::npos);
  drill = Circles();
  drill.circles->diameter = 7;
  EXPECT_NE(PathRefusal(Bored(), Drilling(drill)).find("1 of 6.000 mm"), std::string::npos);
  drill = Circles(Eigen::Vector3d::UnitX());
  EXPECT_NE(PathRefusal(Bored(), Drilling(drill)).find("runs across"), std::string::npos);
  ToolpathOptions large = Drilling(Circles());
  large.cutter.radius = 3.1;
  EXPECT_NE(PathRefusal(Bored(), large).find("too large"), std::string::npos);
  drill = Circles();
  drill.breakthrough.reset();
  const Mesh sheet = SoundMesh(LatheShape({{30, 0}, {3, 0}}, 48));
  EXPECT_NE(PathRefusal(sheet, Drilling(drill)).find("depth_mm: missing"), std::string::npos);
}

TEST(Drill, ARegionChoosesAmongTheHoles) {
  Triangles parts = LatheShape({{3, -20}, {30, -20}, {30, 0}, {3, 0}, {3, -20}}, 48);
  Append(parts, Moved(parts, Eigen::Isometry3d(Eigen::Translation3d(100, 0, 0))));
  ToolpathOptions options = Drilling(Circles());
  EXPECT_EQ(MakeToolpath(SoundMesh(parts), options, {}).passes.size(), 2);
  options.region.half_space = HalfSpace{{50, 0, 0}, Eigen::Vector3d::UnitX()};
  const Toolpath toolpath = MakeToolpath(SoundMesh(parts), options, {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  EXPECT_NEAR(toolpath.passes[0].points[0].position.x(), 100, 1e-9);
}

size_t Gouged(const Mesh& mesh, Toolpath toolpath) {
  return CheckGouges(mesh, kDrill, {}, {.threads = 1}, toolpath).points;
}

TEST(Drill, ItsOwnHoleIsNoGougeButAllElseIs) {
  // Solid material, with and without a wall 2 mm from the hole's middle, and one 4 mm behind the far side.
  const Mesh block = SoundMesh(BoxShape({-30, -30, -10}, {30, 30, 0}));
  Triangles walled = BoxShape({-30, -30, -10}, {30, 30, 0}), behind = walled;
  Append(walled, BoxShape({2, -30, 0.5}, {30, 30, 30}));
  Append(behind, BoxShape({-30, -30, -20}, {30, 30, -14}));
  Drill drill;
  drill.holes = {{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 13.0}};
  const ToolpathOptions options = Drilling(drill);
  EXPECT_EQ(Gouged(block, MakeToolpath(block, options, {})), 0);
  EXPECT_GT(Gouged(SoundMesh(walled), MakeToolpath(SoundMesh(walled), options, {})), 0);
  EXPECT_EQ(Gouged(SoundMesh(behind), MakeToolpath(SoundMesh(behind), options, {})), 0);
  drill.holes[0].depth = 15.0;
  EXPECT_EQ(Gouged(block, MakeToolpath(block, Drilling(drill), {})), 0);
  EXPECT_GT(Gouged(SoundMesh(behind), MakeToolpath(SoundMesh(behind), Drilling(drill), {})), 0);
}

TEST(Drill, SlantedAndRoundSurfacesAreNoWallBesideTheHole) {
  const Mesh ball = SoundMesh(SphereShape(50, 60)), block = SoundMesh(BoxShape({-30, -30, -30}, {30, 30, 0}));
  Drill drill;
  drill.holes = {{{0, 0, 50}, Eigen::Vector3d::UnitZ(), 13.0}};
  EXPECT_EQ(Gouged(ball, MakeToolpath(ball, Drilling(drill), {})), 0);
  drill.holes = {{{0, 0, 0}, Eigen::Vector3d(1, 0, 2).normalized(), 13.0}};
  EXPECT_EQ(Gouged(block, MakeToolpath(block, Drilling(drill), {})), 0);
}

TEST(Drill, FinerPassesHoldThePointsOfTheCoarse) {
  Drill drill = OneHole(11.3);
  drill.peck = 3.1;
  ToolpathOptions options = Drilling(drill);
  const Pass laid = MakeToolpath(None(), options, {}).passes[0];
  options.parts = 4;
  const Pass finer = MakeToolpath(None(), options, {}).passes[0];
  ASSERT_EQ(finer.points.size(), 4 * (laid.points.size() - 1) + 1);
  const std::vector<char> everywhere(laid.points.size(), 1);
  EXPECT_EQ(WithPointsBetween(laid, finer, everywhere).points.size(), finer.points.size());
}

TEST(Drill, TheShortWayIsAnOrderAndNoLonger) {
  RandomStream random(1, 5);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Eigen::Vector3d> places(1 + static_cast<size_t>(random.Below(30)));
    for (Eigen::Vector3d& p : places) p = {random.Uniform(0, 100), random.Uniform(0, 100), 0};
    const std::vector<size_t> order = ShortWay(places);
    std::vector<size_t> sorted = order;
    std::ranges::sort(sorted);
    double way = 0, laid = 0;
    for (size_t i = 0; i < places.size(); ++i) {
      ASSERT_EQ(sorted[i], i);
      if (i == 0) continue;
      way += (places[order[i]] - places[order[i - 1]]).norm();
      laid += (places[i] - places[i - 1]).norm();
    }
    EXPECT_EQ(order[0], 0);
    EXPECT_LE(way, laid + 1e-9);
  }
  // Two rows, laid from row to row and back: along one and back along the other is shortest.
  std::vector<Eigen::Vector3d> rows;
  for (int i = 0; i < 8; ++i)
    for (const double y : {0.0, 50.0}) rows.emplace_back(10 * i, i % 2 == 0 ? y : 50 - y, 0);
  double way = 0;
  const std::vector<size_t> order = ShortWay(rows);
  for (size_t i = 1; i < rows.size(); ++i) way += (rows[order[i]] - rows[order[i - 1]]).norm();
  EXPECT_NEAR(way, 2 * 70 + 50, 1e-9);
}

}  // namespace
}  // namespace millpose
