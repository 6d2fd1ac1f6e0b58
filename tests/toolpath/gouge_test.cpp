// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gouge.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/cutters.hpp"

namespace millpose {
namespace {

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

// The deepest place of a triangle below the cutter's end, by grids that close in on the best place of the one
// before; 0 when it is outside.
double DeepestByGrids(const Triangles& one, const CutterShape& cutter, const Eigen::Vector3d& axis) {
  double best = 0;
  Eigen::Vector2d centre(0.5, 0.5);
  double half = 0.5;
  for (int round = 0; round < 12; ++round) {
    const int n = round == 0 ? 60 : 12;
    const Eigen::Vector2d middle = centre;
    for (int i = 0; i <= n; ++i)
      for (int k = 0; k <= n; ++k) {
        const Eigen::Vector2d w = middle + half * Eigen::Vector2d(2.0 * i / n - 1, 2.0 * k / n - 1);
        const double u = std::clamp(w.x(), 0.0, 1.0), v = std::clamp(w.y(), 0.0, 1 - u);
        const Eigen::Vector3d p = one.vertices[0] + (one.vertices[1] - one.vertices[0]) * u +
                                  (one.vertices[2] - one.vertices[0]) * v;
        const double depth = p.dot(axis) <= cutter.length ? BruteDepth(cutter, axis, p) : 0;
        if (depth > best) {
          best = depth;
          centre = {u, v};
        }
      }
    half /= round == 0 ? 20 : 3;
  }
  return best;
}

TEST(Gouge, DepthAgreesWithBruteForce) {
  RandomStream random(17, 0);
  int gouges = 0;
  for (int i = 0; i < 90; ++i) {
    Triangles one;
    for (int k = 0; k < 3; ++k)
      one.vertices.push_back({random.Uniform(-20, 20), random.Uniform(-20, 20), random.Uniform(-8, 60)});
    if (i % 4 != 0)
      for (auto& p : one.vertices) p.z() /= 10;
    one.faces = {{0, 1, 2}};
    const Mesh mesh = SoundMesh(one);
    const CutterShape& cutter = kCutters[i % 3];
    const double lead = random.Uniform(-0.3, 0.3), tilt = random.Uniform(-0.3, 0.3);
    const Eigen::Vector3d axis = Leaning(lead, tilt);
    const double brute = DeepestByGrids(one, cutter, axis);
    const Gouge gouge = DeepestGouge(mesh, cutter, Eigen::Vector3d::Zero(), axis, 0.001);
    // The search ends at 0.1 %; the grids come within 0.02 mm of places at the cutter's end.
    EXPECT_GE(gouge.depth, brute * 0.999 - 0.002) << i;
    EXPECT_LE(gouge.depth, brute + 0.02) << i;
    EXPECT_EQ(Gouges(mesh, cutter, Eigen::Vector3d::Zero(), axis, 0.02), gouge.depth > 0.02) << i;
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
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kSkip, 0.05}, {.threads = 2}, toolpath);
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
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kLift, 0.05}, {.threads = 1}, toolpath);
  EXPECT_NEAR(report.largest_lift, 4.95, 0.01);
  Toolpath again = toolpath;
  EXPECT_EQ(CheckGouges(mesh, kFlat, {GougeAction::kReport, 0.05}, {.threads = 1}, again).points, 0);
  EXPECT_EQ(toolpath.passes[0].points[0].position.z(), 0);
  EXPECT_GT(toolpath.passes[0].points[12].position.z(), 4.9);
}

TEST(Gouge, ReportedPointsStayAndLeadsGoAsAWhole) {
  const Mesh mesh = Step();
  Toolpath toolpath = TowardsTheStep();
  EXPECT_GT(CheckGouges(mesh, kFlat, {GougeAction::kReport, 0.05}, {.threads = 1}, toolpath).points, 5);
  for (const MillingPoint& point : toolpath.passes[0].points) EXPECT_EQ(point.gouge, 0);
  for (size_t i = 9; i < 16; ++i) toolpath.passes[0].points[i].kind = PointKind::kLeadOut;
  const GougeReport report = CheckGouges(mesh, kFlat, {GougeAction::kSkip, 0.05}, {.threads = 1}, toolpath);
  EXPECT_EQ(report.leads_left_out, 1);
  EXPECT_EQ(toolpath.passes[0].points.size(), 9);
}

TEST(Gouge, ANarrowRibBetweenTwoPointsIsSeen) {
  Triangles part = BoxShape({0, 0, -10}, {100, 100, 0});
  Append(part, BoxShape({49, 0, 0.001}, {50, 100, 5}));
  Toolpath toolpath;
  Pass& pass = toolpath.passes.emplace_back();
  for (const double x : {30.0, 70.0}) pass.points.emplace_back().position = {x, 50, 0};
  EXPECT_EQ(
      CheckGouges(SoundMesh(part), {5, 0, 30}, {GougeAction::kSkip, 0.05}, {.threads = 1}, toolpath).points,
      2);
}

TEST(Gouge, ACutterWhollyInsideIsFound) {
  const CutterShape small{3, 0, 10};
  Triangles hollow = BoxShape({0, 0, -100}, {100, 100, 0});
  Triangles cavity = BoxShape({60, 20, -80}, {90, 80, -20});
  for (size_t face = 0; face < cavity.faces.size(); ++face) Flip(cavity, face);
  Append(hollow, cavity);
  Triangles with_open = hollow;
  Append(with_open, Moved(GridShape(10, 10, 10), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 40))));
  for (const Triangles& part : {hollow, with_open}) {
    Toolpath toolpath;
    Pass& pass = toolpath.passes.emplace_back();
    for (const double z : {-50.0, -45.0})
      pass.points.emplace_back().position = {30, 50, z};  // in the material
    Pass& hole = toolpath.passes.emplace_back();
    for (const double z : {-50.0, -45.0}) hole.points.emplace_back().position = {75, 50, z};  // in the cavity
    const GougeReport report =
        CheckGouges(SoundMesh(part), small, {GougeAction::kSkip, 0.05}, {.threads = 2}, toolpath);
    EXPECT_EQ(report.points, 2);
    EXPECT_NEAR(report.deepest.depth, 30, 1e-9);
    EXPECT_GT(toolpath.passes[0].points[0].gouge, 29);
    EXPECT_EQ(toolpath.passes[1].points[0].gouge, 0);
  }
  // It is not lifted out: that would be by more than its length.
  Toolpath toolpath;
  Pass& pass = toolpath.passes.emplace_back();
  for (const double x : {30.0, 33.0}) pass.points.emplace_back().position = {x, 50, -11};
  CheckGouges(SoundMesh(hollow), small, {GougeAction::kLift, 0.05}, {.threads = 1}, toolpath);
  EXPECT_EQ(pass.points[0].position.z(), -11);
  EXPECT_NEAR(pass.points[0].gouge, 11, 1e-9);
}

TEST(Gouge, BallsAreLiftedOntoSpheres) {
  // Over a sphere of radius ρ a ball of radius R is clear when the centres are ρ + R less the tolerance
  // apart.
  const double rho = 40, tolerance = 0.1;
  const CutterShape ball{8, 8, 60};
  const Mesh mesh = SoundMesh(SphereShape(rho, 90));
  Toolpath toolpath;
  Pass& pass = toolpath.passes.emplace_back();
  for (int i = -15; i <= 15; ++i) pass.points.emplace_back().position = {4.0 * i, 5, 20};
  EXPECT_GT(CheckGouges(mesh, ball, {GougeAction::kLift, tolerance}, {.threads = 2}, toolpath).points, 10);
  for (const MillingPoint& point : pass.points) {
    const double across = point.position.head<2>().norm(), together = rho + 8 - tolerance;
    const double clear = across < together ? std::sqrt(together * together - across * across) - 8 : -100;
    EXPECT_GE(point.position.z(), std::max(20.0, clear) - 0.1) << point.position.transpose();
    // Points at both ends of a way of 4 mm are lifted alike.
    const double nearer = std::max(0.0, across - 4);
    const double most = nearer < together ? std::sqrt(together * together - nearer * nearer) - 8 : -100;
    EXPECT_LE(point.position.z(), std::max(20.0, most) + 0.1) << point.position.transpose();
  }
}

TEST(Gouge, WhatIsLiftedOverHillsIsClearOrMarked) {
  RandomStream random(5, 0);
  for (int round = 0; round < 4; ++round) {
    Triangles hills = GridShape(12, 12, 8);
    for (Eigen::Vector3d& p : hills.vertices) p.z() = random.Uniform(-3, 3);
    const Mesh mesh = SoundMesh(hills);
    const CutterShape& cutter = kCutters[round % 3];
    Toolpath toolpath;
    for (double y = 20; y < 80; y += 15) {
      Pass& pass = toolpath.passes.emplace_back();
      for (double x = 15; x < 80; x += 4) {
        MillingPoint& point = pass.points.emplace_back();
        point.position = mesh.Closest({x, y, 0}).position;
        point.tool_axis = Leaning(0.1, 0.05);
      }
    }
    const GougeReport report =
        CheckGouges(mesh, cutter, {GougeAction::kLift, 0.05}, {.threads = 2}, toolpath);
    EXPECT_GT(report.points, 40);
    EXPECT_GT(report.largest_lift, 0.5);
    size_t marked = 0;
    for (const Pass& pass : toolpath.passes)
      for (const MillingPoint& point : pass.points) {
        marked += point.gouge > 0 ? 1 : 0;
        if (point.gouge == 0) {
          EXPECT_FALSE(Gouges(mesh, cutter, point.position, point.tool_axis, 0.05 + 1e-6));
        }
      }
    Toolpath again = toolpath;
    EXPECT_EQ(CheckGouges(mesh, cutter, {GougeAction::kReport, 0.05}, {.threads = 2}, again).points, marked);
    EXPECT_LT(marked, report.points / 5);
  }
}

}  // namespace
}  // namespace millpose
