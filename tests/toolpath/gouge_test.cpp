// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gouge.hpp"

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

// Depth of a point in a cutter at the origin by its support function: the least way out over many directions.
double BruteDepth(const CutterShape& cutter, const Eigen::Vector3d& axis, const Eigen::Vector3d& p) {
  constexpr int kDirections = 300;
  static const auto directions = [] {
    std::array<Eigen::Vector2d, kDirections + 1> table;
    for (int i = 0; i <= kDirections; ++i)
      table[i] = {std::cos(kPi / 2 * i / kDirections), std::sin(kPi / 2 * i / kDirections)};
    return table;
  }();
  const double z = p.dot(axis), rho = (p - z * axis).norm(), r = cutter.corner_radius;
  double least = 1e9;
  for (const auto& d : directions)
    least = std::min(least, d.x() * (cutter.radius - r - rho) + d.y() * (z - r) + r);
  return least;
}

TEST(Gouge, DepthAgreesWithBruteForce) {
  RandomStream random(17, 0);
  int gouges = 0;
  for (int i = 0; i < 90; ++i) {
    Triangles one;
    for (int k = 0; k < 3; ++k)
      one.vertices.emplace_back(random.Uniform(-20, 20), random.Uniform(-20, 20), random.Uniform(-8, 60));
    if (i % 4 != 0)
      for (auto& p : one.vertices) p.z() /= 10;
    one.faces = {{0, 1, 2}};
    const Mesh mesh = SoundMesh(one);
    const CutterShape& cutter = kCutters[i % 3];
    const Eigen::Vector3d axis = Leaning(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3));
    double brute = 0;
    const int n = 60;
    for (int u = 0; u <= n; ++u)
      for (int v = 0; u + v <= n; ++v) {
        const Eigen::Vector3d p = one.vertices[0] + (one.vertices[1] - one.vertices[0]) * u / n +
                                  (one.vertices[2] - one.vertices[0]) * v / n;
        if (p.dot(axis) <= cutter.length) brute = std::max(brute, BruteDepth(cutter, axis, p));
      }
    const Gouge gouge = DeepestGouge(mesh, cutter, Eigen::Vector3d::Zero(), axis, 0.001);
    // The search ends at 0.1 %; the depth changes by 1 mm per mm, and the grid misses up to a cell.
    EXPECT_GE(gouge.depth, brute * 0.999 - 0.002) << i;
    EXPECT_LE(gouge.depth, brute + 1.2) << i;
    if (gouge.face >= 0) {
      EXPECT_NEAR(BruteDepth(cutter, axis, gouge.place), gouge.depth, 1e-3) << i;
      EXPECT_LT(mesh.Closest(gouge.place).distance, 1e-9);
    }
    gouges += brute > 0.01 ? 1 : 0;
  }
  EXPECT_GT(gouges, 40);
}

TEST(Gouge, LyingOnTheSurfaceIsNone) {
  const Mesh mesh = SoundMesh(GridShape(10, 10, 10));
  for (const CutterShape& cutter : kCutters) {
    const Eigen::Vector3d axis = Leaning(0.05, 0.02);
    const Eigen::Vector3d tip = TipAtContact(cutter, {50, 50, 0}, Eigen::Vector3d::UnitZ(), axis);
    EXPECT_EQ(DeepestGouge(mesh, cutter, tip, axis, 1e-6).depth, 0);
    const Gouge gouge = DeepestGouge(mesh, cutter, tip - 0.5 * axis, axis, 1e-6);
    EXPECT_NEAR(gouge.depth, 0.5, 0.03);  // a flat's edge is left sideways a little sooner
    EXPECT_GE(gouge.face, 0);
  }
}

// A floor of 100 mm with a block of 5 mm height on x > 50.
Mesh Step() {
  Triangles mesh = BoxShape({0, 0, -10}, {100, 100, 0});
  Append(mesh, BoxShape({50, 0, 0.001}, {100, 100, 5}));
  return SoundMesh(mesh);
}

// A straight pass over the floor towards the block, every 4 mm, with a lead-in.
Toolpath TowardsTheStep() {
  Toolpath toolpath;
  Pass& pass = toolpath.passes.emplace_back();
  for (int i = 0; i <= 15; ++i) {
    MillingPoint point;
    point.position = {20.0 + 4 * i, 50, 0};
    point.arc_length = 4.0 * i;
    if (i == 0) point.kind = PointKind::kLeadIn;
    pass.points.push_back(point);
  }
  return toolpath;
}

const CutterShape kFlat{10, 0, 30};

TEST(Gouge, PointsNearAWallAreMarkedAndOnlyThose) {
  const Mesh mesh = Step();
  Toolpath toolpath = TowardsTheStep();
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kSkip, 0.05}, 2, toolpath, {});
  size_t marked = 0;
  for (const MillingPoint& point : toolpath.passes[0].points) {
    // The wall at 50 mm is touched 10 mm before it; half a way is looked at on both sides.
    if (point.position.x() < 38) {
      EXPECT_EQ(point.gouge, 0) << point.position.x();
    }
    if (point.position.x() > 40.1) {
      EXPECT_GT(point.gouge, 0) << point.position.x();
    }
    marked += point.gouge > 0 ? 1 : 0;
  }
  EXPECT_EQ(report.points, marked);
  EXPECT_GE(report.deepest.depth, 5 * 0.998);  // it runs through the whole block
  EXPECT_LE(report.deepest.depth, 5 + 1e-9);
  EXPECT_GT(report.deepest.place.x(), 49.9);
}

TEST(Gouge, LiftedPointsAreClear) {
  const Mesh mesh = Step();
  Toolpath toolpath = TowardsTheStep();
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kLift, 0.05}, 1, toolpath, {});
  EXPECT_NEAR(report.largest_lift, 4.95, 0.01);
  Toolpath again = toolpath;
  EXPECT_EQ(CheckGouges(mesh, kFlat, {GougeAction::kReport, 0.05}, 1, again, {}).points, 0);
  EXPECT_EQ(toolpath.passes[0].points[0].position.z(), 0);
  EXPECT_GT(toolpath.passes[0].points[12].position.z(), 4.9);
}

TEST(Gouge, ReportedPointsStayAndLeadsGoAsAWhole) {
  const Mesh mesh = Step();
  Toolpath toolpath = TowardsTheStep();
  EXPECT_GT(CheckGouges(mesh, kFlat, {GougeAction::kReport, 0.05}, 1, toolpath, {}).points, 5);
  for (const MillingPoint& point : toolpath.passes[0].points) EXPECT_EQ(point.gouge, 0);
  for (size_t i = 9; i < 16; ++i) toolpath.passes[0].points[i].kind = PointKind::kLeadOut;
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kSkip, 0.05}, 1, toolpath, {});
  EXPECT_EQ(report.leads_left_out, 1);
  EXPECT_EQ(toolpath.passes[0].points.size(), 9);
}

TEST(Gouge, ANarrowRibBetweenTwoPointsIsSeen) {
  Triangles part = BoxShape({0, 0, -10}, {100, 100, 0});
  Append(part, BoxShape({49, 0, 0.001}, {50, 100, 5}));
  Toolpath toolpath;
  Pass& pass = toolpath.passes.emplace_back();
  for (const double x : {30.0, 70.0}) pass.points.emplace_back().position = {x, 50, 0};
  EXPECT_EQ(CheckGouges(SoundMesh(part), {5, 0, 30}, {GougeAction::kSkip, 0.05}, 1, toolpath, {}).points, 2);
}

TEST(Gouge, SameAnswerForAnyNumberOfThreads) {
  const Mesh mesh = Step();
  Toolpath one = TowardsTheStep(), four = one;
  CheckGouges(mesh, kFlat, {GougeAction::kLift, 0.05}, 1, one, {});
  CheckGouges(mesh, kFlat, {GougeAction::kLift, 0.05}, 4, four, {});
  for (size_t i = 0; i < one.passes[0].points.size(); ++i)
    EXPECT_EQ(one.passes[0].points[i].position, four.passes[0].points[i].position);
}

}  // namespace
}  // namespace millpose
