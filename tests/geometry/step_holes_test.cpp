// SPDX-License-Identifier: GPL-3.0-or-later
// Holes and edges of STEP parts: drilled and trimmed by their faces' names.
#include "base/units.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/step_reader.hpp"
#include "geometry/mesh/round_holes.hpp"
#include "tests/geometry/step_parts.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/strategies/drill.hpp"
#include "toolpath/strategies/trim.hpp"

namespace millpose {
namespace {

Mesh DrilledBlock(double radius) {
  StepOptions options;
  options.program = MILLPOSE_STEP_PROGRAM;
  return ImportMesh(ReadMesh(DrilledBlockStep("MM", radius), "part.step", options), {1, 1e-4}, "part.step")
      .mesh;
}

// The number of the face of this kind whose triangles all lie at `height`; any height when it is below 0.
std::string FaceNumber(const Mesh& mesh, const std::string& kind, double height) {
  const Triangles& triangles = mesh.triangles();
  for (size_t number = 0; number < triangles.source_faces.size(); ++number) {
    if (triangles.source_faces[number].kind != kind) continue;
    bool level = true;
    for (int face = 0; face < mesh.face_count(); ++face)
      for (int k = 0; k < 3 && triangles.source[static_cast<size_t>(face)] == static_cast<int>(number); ++k)
        level = level && (height < 0 || std::abs(mesh.Corner(face, k).z() - height) < 1e-6);
    if (level) return std::to_string(number + 1);
  }
  return "none";
}

ToolpathOptions Milling(std::shared_ptr<const Strategy> strategy, const std::string& face) {
  ToolpathOptions options;
  options.strategy = std::move(strategy);
  options.cutter = {1, 0, 30};
  options.feed_rate = 1;
  options.region.source_faces = {face};
  return options;
}

TEST(StepHoles, LieOnTheirCylindersWithinAMicrometreHoweverSmall) {
  for (const double radius : {0.8, 1.25, 3.0, 15.0}) {
    const std::vector<RoundHole> holes = FindRoundHoles(DrilledBlock(radius), DegToRad(30), 0.05);
    ASSERT_EQ(holes.size(), 1) << radius;
    EXPECT_EQ(holes[0].kind, HoleKind::kThrough);
    EXPECT_NEAR(holes[0].diameter, 2 * radius, 1e-3);
    EXPECT_NEAR(holes[0].depth, 20, 1e-3);
    for (const double way : {0.0, -20.0})
      EXPECT_LT((holes[0].entrance + way * holes[0].axis - Eigen::Vector3d(50, 30, 20 + way)).norm(), 1e-3);
  }
}

TEST(StepHoles, AreDrilledByTheirFacesNumber) {
  const Mesh mesh = DrilledBlock(1);
  auto drill = std::make_shared<Drill>();
  drill->circles = {2, 0.05, -Eigen::Vector3d::UnitZ()};
  drill->breakthrough = 0.5;
  const Toolpath toolpath = MakeToolpath(mesh, Milling(drill, FaceNumber(mesh, "cylinder", -1)), {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  double highest = 0;
  for (const MillingPoint& point : toolpath.passes[0].points) {
    EXPECT_LT((point.position.head<2>() - Eigen::Vector2d(50, 30)).norm(), 1e-3);
    highest = std::max(highest, point.position.z());
  }
  EXPECT_NEAR(highest, 20.5, 1e-3) << "from below";
}

TEST(StepHoles, EdgesOfAFaceAreTrimmed) {
  const Mesh mesh = DrilledBlock(15);
  auto trim = std::make_shared<Trim>();
  trim->border = TrimBorder{Eigen::Vector3d(50, 44, 20), {}};
  trim->through = 20;
  trim->ramp = DegToRad(20);
  ToolpathOptions options = Milling(trim, FaceNumber(mesh, "plane", 20));
  options.spacing = 2;
  const Toolpath toolpath = MakeToolpath(mesh, options, {});
  ASSERT_EQ(toolpath.passes.size(), 1);
  for (const MillingPoint& point : toolpath.passes[0].points) {
    if (point.kind != PointKind::kCut) continue;
    const double off = (point.position.head<2>() - Eigen::Vector2d(50, 30)).norm();
    EXPECT_LT(off, 14 + 1e-3);
    EXPECT_GT(off, 14 - 0.06) << "the facets' chords";
  }
}

}  // namespace
}  // namespace millpose
