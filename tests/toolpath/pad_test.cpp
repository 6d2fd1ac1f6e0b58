// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

ToolpathOptions Facing(bool spiral) {
  ToolpathOptions options;
  With<Pad>(options);
  options.cutter = {6, 0, 30};
  options.stepover = 5;
  With<Pad>(options).along = Eigen::Vector3d(1, 0.2, 0).normalized();
  With<Pad>(options).spiral = spiral;
  return options;
}

// The tool keeps its offset, comes everywhere but into the corners between its circle and the border, and is
// lifted as seldom as can be. `wanted`: whether a place (within 0..100) is to be milled.
void ExpectFaced(const Mesh& mesh, const ToolpathOptions& options, size_t passes,
                 const std::function<bool(const Eigen::Vector3d&)>& wanted) {
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ExpectSound(mesh, toolpath, options);
  const Region region(mesh, options.region);
  for (const Pass& pass : toolpath.passes)
    for (size_t i = 0; i < pass.points.size(); ++i) {
      ASSERT_GT(region.BorderDistance(pass.points[i].position), 6 - 0.02);
      if (i + 1 == pass.points.size() && !pass.closed) continue;
      const MillingPoint& next = pass.points[(i + 1) % pass.points.size()];
      ASSERT_GT(region.BorderDistance((pass.points[i].position + next.position) / 2), 6 - 0.03);
    }
  for (double x = 3; x < 100; x += 1.7)
    for (double y = 3; y < 100; y += 1.7) {
      const Eigen::Vector3d p(x, y, 0);
      if (mesh.Closest(p).distance > 1e-6 || !wanted(p) || region.BorderDistance(p) < 2.5) continue;
      EXPECT_LT(DistanceFromPath(toolpath, p), 6) << p.transpose();
    }
  EXPECT_LE(toolpath.passes.size(), passes);
}

TEST(Pad, IsFacedAroundAnIslandWithoutAirMoves) {
  // One way through all rings; of a zigzag all lines with one of the borders, and the other border.
  for (const bool spiral : {false, true}) {
    SCOPED_TRACE(spiral);
    ExpectFaced(Plate(), Facing(spiral), spiral ? 1 : 2, [](const Eigen::Vector3d&) { return true; });
  }
}

TEST(Pad, LobesAreReachedWithoutAirMoves) {
  // A dumbbell: two squares of 40 mm, joined by a bridge of 20 mm; rings split where it is too narrow. Lines
  // cut it into five cells without gaps across them; lifting between all of them would be the plain way.
  const Mesh dumbbell = SoundMesh(PlateShape(10, 4, 10, {{{{40, 0}, {60, 10}}}, {{{40, 30}, {60, 40}}}}));
  for (const bool spiral : {false, true}) {
    SCOPED_TRACE(spiral);
    ToolpathOptions options = Facing(spiral);
    With<Pad>(options).along = Eigen::Vector3d::UnitX();
    ExpectFaced(dumbbell, options, spiral ? 1 : 3, [](const Eigen::Vector3d&) { return true; });
  }
}

TEST(Pad, EndsAtBoxesAndPolygonsAlongItsPlane) {
  // A box that is flat along the pad's plane must not make the pad look narrow.
  for (const bool spiral : {false, true})
    for (const bool box : {false, true}) {
      SCOPED_TRACE(fmt::format("spiral {} box {}", spiral, box));
      ToolpathOptions options = Facing(spiral);
      if (box) {
        options.region.box = RegionBox{Eigen::Vector3d(-10, -10, -0.01), Eigen::Vector3d(30, 200, 0.01)};
      } else {
        options.region.polygon = {{{-10, -10, 40}, {30, -10, 40}, {30, 200, 40}, {-10, 200, 40}},
                                  Eigen::Vector3d::UnitZ()};
      }
      ExpectFaced(Plate(), options, 1, [](const Eigen::Vector3d& p) { return p.x() < 30; });
    }
}

TEST(Pad, SpiralsAreNoLongerThanTheirRings) {
  const ToolpathOptions options = Facing(true);
  double length = 0;
  for (const Pass& pass : MakeToolpath(Plate(), options, {}).passes) length += pass.points.back().arc_length;
  EXPECT_LT(length,
            1.3 * (100 * 100 - 20 * 20) / options.stepover);  // the area over the step-over, and links
}

TEST(Pad, ClimbAndConventionalHoldOnRingsAndLines) {
  // But for the small rings in corners, which have what is milled on two sides.
  for (const bool spiral : {false, true}) {
    ToolpathOptions options = Facing(spiral);
    options.spacing = 1;
    options.direction = Direction::kClimb;
    EXPECT_GT(ClimbShare(MakeToolpath(Plate(), options, {}), options.stepover), spiral ? 0.92 : 0.99)
        << spiral;
    options.direction = Direction::kConventional;
    EXPECT_LT(ClimbShare(MakeToolpath(Plate(), options, {}), options.stepover), spiral ? 0.08 : 0.01)
        << spiral;
  }
}

TEST(Pad, IsNotLinkedAcrossLinkMoves) {
  // Two plates, 10 mm apart: nearer than two step-overs and a half, but there is nothing between them.
  const Mesh plates = SoundMesh(PlateShape(7, 3, 10, {{{{30, 0}, {40, 30}}}}));
  ToolpathOptions options = Facing(true);
  With<Pad>(options).offset = 0;
  EXPECT_EQ(MakeToolpath(plates, options, {}).passes.size(), 2);
}

TEST(Pad, StandsUprightBesideAFillet) {
  // A floor of 60 mm whose edge bends up by 15°: normals averaged over the edge would lean over the whole
  // floor.
  Triangles floor = GridShape(1, 1, 60);
  const int first = static_cast<int>(floor.vertices.size());
  for (const double y : {0.0, 60.0})
    floor.vertices.emplace_back(60 + 2 * std::cos(DegToRad(15)), y, 2 * std::sin(DegToRad(15)));
  floor.faces.push_back({1, first, first + 1});
  floor.faces.push_back({1, first + 1, 3});
  const Mesh mesh = SoundMesh(floor);
  for (const bool spiral : {false, true}) {
    ToolpathOptions options = Facing(spiral);
    options.region.facing = Eigen::Vector3d::UnitZ();
    options.region.facing_within = DegToRad(1);
    for (const Pass& pass : MakeToolpath(mesh, options, {}).passes)
      for (const MillingPoint& point : pass.points)
        ASSERT_LT((point.tool_axis - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
}

TEST(Pad, PadsMustBePlane) {
  ToolpathOptions options;
  With<Pad>(options);
  options.cutter = {6, 0, 30};
  options.stepover = 8;
  options.region.connected = {{60, 0, 20}, DegToRad(20)};
  try {
    MakeToolpath(SoundMesh(CylinderShape(60, 40, 72, 2)), options, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("needs a plane region"), std::string::npos);
  }
}

}  // namespace
}  // namespace millpose
