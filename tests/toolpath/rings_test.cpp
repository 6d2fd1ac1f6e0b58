// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

TEST(Rings, RingsAreClosedRoundAndInOrder) {
  const Mesh mesh = SampleMesh("cabin_ring");
  ToolpathOptions options;
  With<Rings>(options);
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(1);
  options.region.rim_distance = 2;
  options.stepover = 10;
  options.rotation_reference = Eigen::Vector3d::UnitX();
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 5);
  ExpectSound(mesh, toolpath, options);
  double radius = 0;
  for (const Pass& pass : toolpath.passes) {
    EXPECT_TRUE(pass.closed);
    EXPECT_LT((pass.points.front().position.normalized() - Eigen::Vector3d::UnitX()).norm(), 1e-6);
    const double own = pass.points.front().position.norm();
    EXPECT_GT(own, radius);
    radius = own;
    for (const MillingPoint& point : pass.points) {
      EXPECT_NEAR(point.position.norm(), own, 1e-9);
      EXPECT_GT(Eigen::Vector3d::UnitZ().cross(point.position).dot(point.feed), 0.999 * own);
    }
    const double gap = (pass.points.front().position - pass.points.back().position).norm();
    EXPECT_GT(gap, 1);
    EXPECT_LE(gap, options.spacing + 1e-9);
  }
}

TEST(Rings, OpenRingsSayWhereTheyMayBegin) {
  ToolpathOptions options = WallRings();
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  With<Rings>(options).path = RingPath::kOpen;
  options.ends.lead = LeadShape::kArc;
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes) {
    EXPECT_TRUE(pass.closed) << "the planner opens it, with leads there";
    EXPECT_EQ(pass.opening, RingOpening::kAnywhere);
  }
  With<Rings>(options).start = DegToRad(90);
  const Toolpath given = MakeToolpath(mesh, options, {});
  EXPECT_EQ(given.passes[0].opening, RingOpening::kAtStart);
  EXPECT_LT((given.passes[0].points[0].position - Eigen::Vector3d(0, 60, 5)).norm(), 1e-6);
  With<Rings>(options).path = RingPath::kClosed;
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes) {
    EXPECT_FALSE(pass.closed) << "a lead opens what stays closed without";
    EXPECT_EQ(pass.opening, RingOpening::kNone);
  }
}

TEST(Rings, RingsGoRoundWallsToo) {
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  ToolpathOptions options = WallRings();
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 4);
  ExpectSound(mesh, toolpath, options);
  for (size_t i = 0; i < 4; ++i) {
    const Pass& pass = toolpath.passes[i];
    EXPECT_TRUE(pass.closed);
    EXPECT_LT((pass.points[0].position - Eigen::Vector3d(60, 0, 5 + 10.0 * static_cast<double>(i))).norm(),
              1e-6);
    for (const MillingPoint& point : pass.points)
      EXPECT_GT(Eigen::Vector3d::UnitZ().cross(point.position).dot(point.feed), 0);
  }
  With<Rings>(options).seam_step = DegToRad(90);
  const Toolpath moved = MakeToolpath(mesh, options, {});
  EXPECT_LT((moved.passes[1].points[0].position - Eigen::Vector3d(0, 60, 15)).norm(), 1e-6);
  EXPECT_LT((moved.passes[2].points[0].position - Eigen::Vector3d(-60, 0, 25)).norm(), 1e-6);
  // An inner wall, seen from the axis, is milled the same way round.
  Triangles pipe = CylinderShape(60, 40, 72, 2);
  for (size_t face = 0; face < pipe.faces.size(); ++face) Flip(pipe, face);
  std::erase_if(pipe.faces, [&](const std::array<int, 3>& face) {
    return std::ranges::all_of(face, [&](int v) { return pipe.vertices[v].z() == 40; });
  });
  for (const Pass& pass : MakeToolpath(SoundMesh(pipe), WallRings(), {}).passes)
    for (const MillingPoint& point : pass.points) {
      EXPECT_LT(point.normal.dot(point.position), 0);
      EXPECT_GT(Eigen::Vector3d::UnitZ().cross(point.position).dot(point.feed), 0);
    }
}

TEST(Rings, SpiralIsOnePassWithEvenTurns) {
  const Mesh wall = SoundMesh(CylinderShape(60, 40, 360, 2)), face = SampleMesh("cabin_ring");
  for (const bool on_wall : {true, false}) {
    ToolpathOptions options = WallRings();
    if (!on_wall) {
      options.region.connected.reset();
      options.region.facing = Eigen::Vector3d::UnitZ();
      options.region.facing_within = DegToRad(1);
    }
    options.stepover = on_wall ? 8 : 16;
    options.region.rim_distance = on_wall ? 0 : 2;
    With<Rings>(options).path = RingPath::kSpiral;
    const Mesh& mesh = on_wall ? wall : face;
    const Toolpath toolpath = MakeToolpath(mesh, options, {});
    ASSERT_EQ(toolpath.passes.size(), 1) << on_wall;
    ExpectSound(mesh, toolpath, options);
    double turned = 0, last = on_wall ? 4 : toolpath.passes[0].points[0].position.norm();
    const auto& points = toolpath.passes[0].points;
    const double first = last, end = on_wall ? 36 : points.back().position.norm();
    const double windings = on_wall ? 4 : 2, pitch = (end - first) / windings;
    EXPECT_LE(pitch, options.stepover + 1e-9);
    for (size_t i = 1; i < points.size(); ++i) {
      const Eigen::Vector3d &p = points[i - 1].position, &q = points[i].position;
      const double step = std::atan2(p.x() * q.y() - p.y() * q.x(), p.x() * q.x() + p.y() * q.y());
      EXPECT_GT(step, 0);
      turned += step;
      const double place = on_wall ? q.z() : q.head<2>().norm();
      EXPECT_GT(place, last - 0.02);
      last = place;
      // A ring, then the spiral with its pitch, then a ring.
      const double turns = turned / (2 * kPi) - 1;
      const double wanted = first + pitch * std::clamp(turns, 0.0, windings);
      EXPECT_NEAR(place, wanted, 0.05) << on_wall << " " << turns;
    }
    EXPECT_NEAR(turned, (windings + 2) * 2 * kPi, 0.02);
  }
}

TEST(Rings, SpiralsTooFineForMemoryAreRefused) {
  // Turns 0.05 mm apart on a plate of 400 mm.
  ToolpathOptions options;
  With<Rings>(options);
  With<Rings>(options).path = RingPath::kSpiral;
  options.stepover = 0.05;
  try {
    MakeToolpath(SoundMesh(GridShape(20, 20, 20)), options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("larger step-over"), std::string::npos);
  }
}

TEST(Rings, ClimbAndConventionalHoldOnFacesAndWallsInsideAndOut) {
  Triangles pipe = CylinderShape(60, 40, 72, 2);
  for (size_t face = 0; face < pipe.faces.size(); ++face) Flip(pipe, face);
  std::erase_if(pipe.faces, [&](const std::array<int, 3>& face) {
    return std::ranges::all_of(face, [&](int v) { return pipe.vertices[v].z() == 40; });
  });
  ToolpathOptions face = WallRings();
  face.region.connected.reset();
  face.region.facing = Eigen::Vector3d::UnitZ();
  face.region.facing_within = DegToRad(1);
  ToolpathOptions from_below = WallRings();
  With<Rings>(from_below).axis_direction = -Eigen::Vector3d::UnitZ();
  const Mesh cylinder = SoundMesh(CylinderShape(60, 40, 72, 2));
  for (const auto& [name, mesh, given] :
       {std::tuple("wall", cylinder, WallRings()), std::tuple("inner wall", SoundMesh(pipe), WallRings()),
        std::tuple("face", cylinder, face), std::tuple("axis turned round", cylinder, from_below)})
    for (const bool spiral : {false, true}) {
      SCOPED_TRACE(fmt::format("{} spiral {}", name, spiral));
      ToolpathOptions options = given;
      With<Rings>(options).path = spiral ? RingPath::kSpiral : RingPath::kClosed;
      options.spacing = 4;
      options.direction = Direction::kClimb;
      EXPECT_GT(ClimbShare(MakeToolpath(mesh, options, {}), options.stepover), 0.95);
      options.direction = Direction::kConventional;
      EXPECT_LT(ClimbShare(MakeToolpath(mesh, options, {}), options.stepover), 0.05);
    }
}

TEST(Rings, SpiralsOverSteepFacesNeedTrianglesOnlyWherePassesAreDense) {
  // A dome from flat to 80°: passes on the surface are up to six times as dense in radius at its foot. One
  // spacing for the whole dome would take about thirty times the triangles, and longer than all other tests.
  Triangles dome = SphereShape(200, 60);
  std::erase_if(dome.faces, [&](const std::array<int, 3>& f) {
    return std::ranges::any_of(f, [&](int v) { return dome.vertices[v].z() < 200 * std::cos(DegToRad(80)); });
  });
  ToolpathOptions options;
  With<Rings>(options);
  With<Rings>(options).surface = RingSurface::kFaces;
  With<Rings>(options).path = RingPath::kSpiral;
  options.stepover = 18;
  options.stepover_on_surface = true;
  options.chord_tolerance = 0.1;
  options.rotation_reference = Eigen::Vector3d::UnitX();
  const Mesh mesh = SoundMesh(dome);
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  ExpectSound(mesh, toolpath, options);
  // Along a meridian the turns lie as far apart on the surface as wanted.
  std::vector<double> slopes;
  const auto& points = toolpath.passes[0].points;
  for (size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector3d &p = points[i - 1].position, &q = points[i].position;
    if (p.y() < 0 && q.y() >= 0 && q.x() < 0) slopes.push_back(std::atan2(q.head<2>().norm(), q.z()));
    if (p.y() >= 0 && q.y() < 0 && q.x() < 0) slopes.push_back(std::atan2(q.head<2>().norm(), q.z()));
  }
  ASSERT_GT(slopes.size(), 15);
  for (size_t i = 2; i + 2 < slopes.size(); ++i) {
    EXPECT_LE(200 * (slopes[i] - slopes[i - 1]), options.stepover * 1.02) << i;
    EXPECT_GE(200 * (slopes[i] - slopes[i - 1]), options.stepover * 0.85) << i;
  }
}

}  // namespace
}  // namespace millpose
