// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/make_toolpath.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "surface/mesh_import.hpp"
#include "tests/surface/shapes.hpp"
#include "toolpath/gouge.hpp"

namespace millpose {
namespace {

Mesh Sample(const std::string& name) {
  const std::string path = fmt::format("{}/toolpaths/{}/{}.stl", MILLPOSE_SOURCE_DIR, name, name);
  return ImportMesh(ReadMesh(ReadFile(path), path), {}, path).mesh;
}

size_t PointsOf(const Toolpath& toolpath) {
  size_t points = 0;
  for (const Pass& pass : toolpath.passes) points += pass.points.size();
  return points;
}

// What holds for every tool path of a mesh.
void ExpectSound(const Mesh& mesh, const Toolpath& toolpath, const ToolpathOptions& options) {
  for (const Pass& pass : toolpath.passes) {
    ASSERT_GE(pass.points.size(), 2);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const MillingPoint& point = pass.points[i];
      ASSERT_LT(mesh.Closest(point.position).distance, 1e-6);
      ASSERT_NEAR(point.normal.norm(), 1, 1e-9);
      ASSERT_NEAR(point.feed.norm(), 1, 1e-9);
      ASSERT_NEAR(point.tool_axis.norm(), 1, 1e-9);
      ASSERT_NEAR(point.feed.dot(point.normal), 0, 1e-9);
      if (i == 0) continue;
      const Eigen::Vector3d step = point.position - pass.points[i - 1].position;
      ASSERT_LE(step.norm(), options.spacing + 1e-9);
      ASSERT_GT(step.dot(point.feed), 0);
      ASSERT_NEAR(point.arc_length - pass.points[i - 1].arc_length, step.norm(), options.chord_tolerance * 4);
    }
  }
}

ToolpathOptions PadOptions() {
  ToolpathOptions options;
  options.plane_normal = Eigen::Vector3d::UnitY();
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(1);
  options.stepover = 8;
  options.spacing = 4;
  return options;
}

TEST(MakeToolpath, SupportPadIsCoveredInZigzag) {
  const Mesh mesh = Sample("support_pad");
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

TEST(MakeToolpath, OneWayKeepsTheDirection) {
  ToolpathOptions options = PadOptions();
  options.direction = Direction::kOneWay;
  for (const Pass& pass : MakeToolpath(Sample("support_pad"), options, {}).passes)
    EXPECT_NEAR(pass.points.front().position.x(), -40, 1e-9);
}

TEST(MakeToolpath, LeadLeansForwardAndTiltToTheRight) {
  ToolpathOptions options = PadOptions();
  options.lead = DegToRad(10);
  MillingPoint point = MakeToolpath(Sample("support_pad"), options, {}).passes[0].points[3];
  EXPECT_LT((point.tool_axis - Eigen::Vector3d(std::sin(options.lead), 0, std::cos(options.lead))).norm(),
            1e-12);
  options.lead = 0;
  options.tilt = DegToRad(5);
  point = MakeToolpath(Sample("support_pad"), options, {}).passes[0].points[3];
  EXPECT_LT((point.tool_axis - Eigen::Vector3d(0, -std::sin(options.tilt), std::cos(options.tilt))).norm(),
            1e-12);
}

TEST(MakeToolpath, RegionCutsExactly) {
  ToolpathOptions options = PadOptions();
  options.region.box = {Eigen::Vector3d(-13.37, -100, -1), Eigen::Vector3d(21.1, 100, 1)};
  for (const Pass& pass : MakeToolpath(Sample("support_pad"), options, {}).passes) {
    const auto [low, high] = std::minmax(pass.points.front().position.x(), pass.points.back().position.x());
    EXPECT_NEAR(low, -13.37, 2e-7);
    EXPECT_NEAR(high, 21.1, 2e-7);
    EXPECT_GE(low, -13.37 - 1e-9);
    EXPECT_LE(high, 21.1 + 1e-9);
  }
  options.region.box.reset();
  options.region.rim_distance = 7.25;
  const Toolpath inner = MakeToolpath(Sample("support_pad"), options, {});
  EXPECT_EQ(inner.passes.size(), 9);  // 65.5 mm in steps of at most 8
  for (const Pass& pass : inner.passes) {
    EXPECT_NEAR(std::abs(pass.points.front().position.x()), 40 - 7.25, 2e-7);
    EXPECT_NEAR(std::abs(pass.points.back().position.x()), 40 - 7.25, 2e-7);
  }
}

TEST(MakeToolpath, WindowAndPadsInterruptPasses) {
  const Mesh mesh = Sample("cabin_panel");
  ToolpathOptions options;
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

TEST(MakeToolpath, RingsAreClosedRoundAndInOrder) {
  const Mesh mesh = Sample("cabin_ring");
  ToolpathOptions options;
  options.strategy = "rings";
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

TEST(MakeToolpath, ClosedSlicesOfACylinderAreClosedPassesInOrder) {
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  ToolpathOptions options;
  options.plane_normal = Eigen::Vector3d::UnitZ();
  options.stepover = 10;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 4);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(toolpath.passes[i].closed);
    EXPECT_NEAR(toolpath.passes[i].points[0].position.z(), 5 + 10.0 * static_cast<double>(i), 1e-9);
  }
  ExpectSound(mesh, toolpath, options);
}

TEST(MakeToolpath, PassesEndAtCreases) {
  // Sliced along its axis the closed cylinder gives walls and caps as passes of their own.
  const Mesh mesh = SoundMesh(CylinderShape(60, 40, 72, 2));
  ToolpathOptions options;
  options.plane_normal = Eigen::Vector3d::UnitX();
  options.stepover = 200;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  EXPECT_EQ(toolpath.passes.size(), 4);
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points)
      EXPECT_LT((point.normal - pass.points[0].normal).norm(), 1e-12);
}

TEST(MakeToolpath, FarFromTheOriginAndTurnedIsTheSame) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translate(Eigen::Vector3d(1e5, -2e5, 3e4));
  const Mesh near = SoundMesh(CylinderShape(60, 40, 72, 2)), far = SoundMesh(Moved(near.triangles(), X));
  ToolpathOptions options;
  options.plane_normal = Eigen::Vector3d(0, 0.6, 0.8);
  options.stepover = 7;
  options.region.facing = Eigen::Vector3d::UnitX();
  options.region.rim_distance = 3;
  const Toolpath a = MakeToolpath(near, options, {}), b = MakeToolpath(far, options, {});
  ASSERT_EQ(a.passes.size(), b.passes.size());
  const Toolpath moved = Transformed(a, X);
  for (size_t i = 0; i < a.passes.size(); ++i) {
    ASSERT_EQ(a.passes[i].points.size(), b.passes[i].points.size());
    for (size_t k = 0; k < a.passes[i].points.size(); ++k)
      EXPECT_LT((moved.passes[i].points[k].position - b.passes[i].points[k].position).norm(), 1e-6);
  }
}

TEST(MakeToolpath, TransformTurnsDirectionsToo) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translate(Eigen::Vector3d(1, 2, 3));
  X.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  const Toolpath a = MakeToolpath(Sample("support_pad"), PadOptions(), {}), b = Transformed(a, X);
  const MillingPoint &p = a.passes[3].points[5], &q = b.passes[3].points[5];
  EXPECT_LT((q.position - X * p.position).norm(), 1e-12);
  EXPECT_LT((q.feed - X.linear() * p.feed).norm(), 1e-12);
  EXPECT_LT((q.tool_axis - X.linear() * p.tool_axis).norm(), 1e-12);
  EXPECT_LT((b.passes[3].rotation_reference - X.linear() * a.passes[3].rotation_reference).norm(), 1e-12);
}

TEST(MakeToolpath, ContoursKeepTheirDistanceFromTheRims) {
  const Mesh mesh = Sample("support_pad");
  ToolpathOptions options = PadOptions();
  options.strategy = "contours";
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

TEST(MakeToolpath, ContoursGoRoundIslands) {
  const Mesh mesh = Sample("cabin_panel");
  ToolpathOptions options;
  options.strategy = "contours";
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

TEST(MakeToolpath, SingleCurveIsProjectedOntoThePart) {
  const Mesh mesh = Sample("cabin_panel");
  ToolpathOptions options;
  options.strategy = "curve";
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(60);
  options.curve_points = {{-280, -400, 99}, {-100, -390, 50}, {-100, -200, 0}};
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  ExpectSound(mesh, toolpath, options);
  const auto& points = toolpath.passes[0].points;
  EXPECT_LT((points.front().position - options.curve_points.front()).head<2>().norm(), 1e-6);
  EXPECT_LT((points.back().position - options.curve_points.back()).head<2>().norm(), 1e-6);
  double nearest = 1e9;
  for (const MillingPoint& point : points) {
    nearest = std::min(nearest, (point.position - options.curve_points[1]).head<2>().norm());
    EXPECT_NEAR(std::hypot(point.position.y(), point.position.z() + 1500), 1500, 0.1);
  }
  EXPECT_LT(nearest, 1e-6);
}

TEST(MakeToolpath, LeaningCutterTouchesTheContactAndDoesNotGouge) {
  const Mesh mesh = Sample("support_pad");
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

ToolpathOptions WallRings() {
  ToolpathOptions options;
  options.strategy = "rings";
  options.region.connected = {{60, 0, 20}, DegToRad(20)};
  options.rotation_reference = Eigen::Vector3d::UnitX();
  options.stepover = 10;
  return options;
}

TEST(MakeToolpath, RingsGoRoundWallsToo) {
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
  options.seam_step = DegToRad(90);
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

TEST(MakeToolpath, SpiralIsOnePassWithEvenTurns) {
  const Mesh wall = SoundMesh(CylinderShape(60, 40, 360, 2)), face = Sample("cabin_ring");
  for (const bool on_wall : {true, false}) {
    ToolpathOptions options = WallRings();
    if (!on_wall) {
      options.region.connected.reset();
      options.region.facing = Eigen::Vector3d::UnitZ();
      options.region.facing_within = DegToRad(1);
    }
    options.stepover = on_wall ? 8 : 16;
    options.region.rim_distance = on_wall ? 0 : 2;
    options.spiral = true;
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

TEST(MakeToolpath, SpiralsTooFineForMemoryAreRefused) {
  // Turns 0.05 mm apart on a plate of 400 mm.
  ToolpathOptions options;
  options.strategy = "rings";
  options.spiral = true;
  options.stepover = 0.05;
  try {
    MakeToolpath(SoundMesh(GridShape(20, 20, 20)), options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("larger step-over"), std::string::npos);
  }
}

// A plate of 100 mm with a square hole of 20 mm in its middle.
Mesh Plate() {
  Triangles grid = GridShape(10, 10, 10);
  std::erase_if(grid.faces, [&](const std::array<int, 3>& face) {
    return std::ranges::all_of(face, [&](int v) {
      return (grid.vertices[v] - Eigen::Vector3d(50, 50, 0)).cwiseAbs().maxCoeff() < 11;
    });
  });
  return SoundMesh(grid);
}

double DistanceFromPath(const Toolpath& toolpath, const Eigen::Vector3d& p) {
  double least = 1e9;
  for (const Pass& pass : toolpath.passes)
    for (size_t i = pass.closed ? 0 : 1; i < pass.points.size(); ++i) {
      const Eigen::Vector3d& a = pass.points[i > 0 ? i - 1 : pass.points.size() - 1].position;
      const Eigen::Vector3d way = pass.points[i].position - a;
      const double t = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (a + t * way - p).norm());
    }
  return least;
}

TEST(MakeToolpath, PadsAreFacedAroundIslands) {
  const Mesh mesh = Plate();
  ToolpathOptions options;
  options.strategy = "pad";
  options.cutter = {6, 0, 30};
  options.stepover = 5;
  options.pad_direction = Eigen::Vector3d(1, 0.2, 0).normalized();
  const Region region(mesh, {});
  for (const bool spiral : {false, true}) {
    options.spiral = spiral;
    const Toolpath toolpath = MakeToolpath(mesh, options, {});
    for (const Pass& pass : toolpath.passes)
      for (size_t i = 0; i < pass.points.size(); ++i) {
        EXPECT_GT(region.BorderDistance(pass.points[i].position), 6 - 0.02);
        const MillingPoint& next = pass.points[(i + 1) % pass.points.size()];
        if (i + 1 < pass.points.size() || pass.closed) {
          EXPECT_GT(region.BorderDistance((pass.points[i].position + next.position) / 2), 6 - 0.03);
        }
      }
    // The cutter comes everywhere but into the corners between its circle and the border.
    for (double x = 3; x < 100; x += 1.7)
      for (double y = 3; y < 100; y += 1.7) {
        const Eigen::Vector3d p(x, y, 0);
        if ((p - Eigen::Vector3d(50, 50, 0)).cwiseAbs().maxCoeff() < 11 || region.BorderDistance(p) < 2.5)
          continue;
        EXPECT_LT(DistanceFromPath(toolpath, p), 6) << spiral << " " << p.transpose();
      }
    // Rings left in the four corners, or lines cut by the island, are passes of their own.
    EXPECT_LE(toolpath.passes.size(), spiral ? 5 : 8) << spiral;
  }
}

TEST(MakeToolpath, PadsMustBePlane) {
  ToolpathOptions options;
  options.strategy = "pad";
  options.cutter = {6, 0, 30};
  options.region.connected = {{60, 0, 20}, DegToRad(20)};
  try {
    MakeToolpath(SoundMesh(CylinderShape(60, 40, 72, 2)), options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("needs a plane region"), std::string::npos);
  }
}

TEST(MakeToolpath, ClimbHasTheUnmilledMaterialOnTheRight) {
  const Mesh mesh = Sample("support_pad");
  for (const char* strategy : {"parallel_planes", "contours"})
    for (const bool climb : {true, false}) {
      ToolpathOptions options = PadOptions();
      options.strategy = strategy;
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
  options.strategy = "curve";
  options.curve_points = {{-30, 0, 0}, {30, 0, 0}};
  options.direction = Direction::kClimb;
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
}

TEST(MakeToolpath, OrderByTravelIsAPermutationWithShorterWays) {
  const Mesh mesh = Sample("cabin_panel");
  ToolpathOptions options;
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

TEST(MakeToolpath, ScaledFromMetresIsTheSame) {
  RawMesh millimetres, metres;
  millimetres.triangles = metres.triangles = CylinderShape(60, 40, 72, 2);
  for (Eigen::Vector3d& p : metres.triangles.vertices) p /= 1000;
  ImportOptions scale;
  scale.unit = 1000;
  const Mesh a = ImportMesh(millimetres, {}, "a").mesh, b = ImportMesh(metres, scale, "b").mesh;
  ToolpathOptions options = WallRings();
  const Toolpath first = MakeToolpath(a, options, {}), second = MakeToolpath(b, options, {});
  ASSERT_EQ(PointsOf(first), PointsOf(second));
  for (size_t i = 0; i < first.passes.size(); ++i)
    for (size_t k = 0; k < first.passes[i].points.size(); ++k)
      EXPECT_LT((first.passes[i].points[k].position - second.passes[i].points[k].position).norm(), 1e-6);
}

TEST(MakeToolpath, WallsOfAThinSolidAreNotAveraged) {
  // A closed sheet of 0.5 mm: each point has the normal of its own side.
  const Mesh mesh = SoundMesh(BoxShape({0, 0, 0}, {100, 80, 0.5}));
  ToolpathOptions options;
  options.stepover = 10;
  options.normal_smoothing = 20;
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes)
    for (const MillingPoint& point : pass.points) EXPECT_NEAR(point.normal.cwiseAbs().maxCoeff(), 1, 1e-12);
}

TEST(MakeToolpath, SaysWhatIsWrong) {
  const Mesh mesh = Sample("support_pad");
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
  options.strategy = "ring";
  try {
    MakeToolpath(mesh, options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"rings\"?"), std::string::npos) << error.what();
  }
  options = PadOptions();
  options.region.facing = Eigen::Vector3d(1, 1, 1).normalized();
  EXPECT_THROW(MakeToolpath(mesh, options, {}), InputError);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(MakeToolpath(mesh, PadOptions(), source.get_token()), Interrupted);
}

}  // namespace
}  // namespace millpose
