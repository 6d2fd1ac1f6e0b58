// SPDX-License-Identifier: GPL-3.0-or-later
// IGES parts, made by OpenCASCADE here and read by millpose-step, beside the same part as STEP.
#include "base/error.hpp"
#include "base/units.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/step_reader.hpp"
#include "tests/base/refusal.hpp"
#include "tests/geometry/mutate.hpp"
#include "tests/geometry/step_parts.hpp"

namespace millpose {
namespace {

StepOptions IgesOptions() {
  StepOptions options;
  options.program = MILLPOSE_STEP_PROGRAM;
  return options;
}

ImportResult ImportedCad(const std::string& bytes, double unit) {
  return ImportMesh(ReadMesh(bytes, "part", IgesOptions()), {unit, 1e-4}, "part");
}

std::string IgesError(const std::string& bytes) {
  return RefusalOf([&] { ReadMesh(bytes, "part.igs", IgesOptions()); });
}

double VolumeOf(const Mesh& mesh) {
  double six_volumes = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    six_volumes += mesh.Corner(f, 0).dot(mesh.Corner(f, 1).cross(mesh.Corner(f, 2)));
  return six_volumes / 6;
}

TEST(Iges, PartIsThatOfStep) {
  const ImportResult step = ImportedCad(DrilledBlockStep("MM"), 1);
  const double exact = 100 * 60 * 20 - kPi * 15 * 15 * 20;
  ASSERT_NEAR(VolumeOf(step.mesh), exact, 2e-3 * exact);
  for (const auto& [name, unit] : {std::pair("MM", 1.0), std::pair("INCH", 25.4), std::pair("M", 1000.0)})
    for (const bool solid : {true, false}) {
      const std::string iges = DrilledBlockIges(name, solid);
      ASSERT_EQ(CadFormatOf(iges), CadFormat::kIges);
      EXPECT_EQ(ReadMesh(iges, "part", IgesOptions()).stated_unit, unit);
      const ImportResult import = ImportedCad(iges, unit);
      const std::string what = name + std::string(solid ? " solid" : " surfaces");
      EXPECT_EQ(import.report.rims, 0u) << what;
      EXPECT_EQ(import.report.closed_pieces, 1u) << what;
      EXPECT_EQ(import.report.bodies.size(), 1u) << what;
      EXPECT_EQ(import.report.notes, std::vector<std::string>{}) << what;
      EXPECT_LT((import.report.lower - step.report.lower).norm(), 1e-6) << what;
      EXPECT_LT((import.report.upper - step.report.upper).norm(), 1e-6) << what;
      EXPECT_NEAR(VolumeOf(import.mesh), VolumeOf(step.mesh), 1e-3 * exact) << what;
      const std::vector<SourceFace>& faces = import.mesh.triangles().source_faces;
      double area = 0;
      for (const SourceFace& face : faces) {
        area += face.area;
        EXPECT_NE(face.id, "#0") << what;
        EXPECT_FALSE(face.lost) << what;
      }
      EXPECT_NEAR(area, 2 * (6000 + 1200 + 2000 - kPi * 225) + 2 * kPi * 15 * 20, 1e-2) << what;
      for (int f = 0; f < import.mesh.face_count(); ++f)
        for (int k = 0; k < 3; ++k) {
          // Every vertex lies on the block: on its outside, or on the wall of the hole.
          const Eigen::Vector3d p = import.mesh.Corner(f, k);
          const double outside = std::min({std::abs(p.x()), std::abs(p.x() - 100), std::abs(p.y()),
                                           std::abs(p.y() - 60), std::abs(p.z()), std::abs(p.z() - 20)});
          EXPECT_LT(std::min(outside, std::abs((p.head<2>() - Eigen::Vector2d(50, 30)).norm() - 15)), 1e-5)
              << what;
        }
    }
}

TEST(Iges, UnitMustBeTheJobs) {
  EXPECT_EQ(RefusalOf([] { ImportedCad(DrilledBlockIges("INCH", true), 1); }),
            "part: the file states that its unit is 25.4 mm, given 1 mm");
}

TEST(Iges, WhatWasCutOffIsNoSmallerPart) {
  const std::string sound = DrilledBlockIges("MM", false);
  for (const double share : {0.1, 0.5, 0.9}) {
    const auto length = static_cast<size_t>(share * static_cast<double>(sound.size()));
    EXPECT_EQ(IgesError(sound.substr(0, length)),
              "part.igs: the IGES file is cut off: its last section (T) is missing");
  }
  // A line of a surface is gone.
  std::string shorter = sound;
  const size_t line = sound.find('\n') + 1;
  shorter.erase(line * (sound.size() / line / 2), line);
  EXPECT_NE(IgesError(shorter).find("the IGES file is damaged: its last line states"), std::string::npos)
      << IgesError(shorter);
}

TEST(Iges, DamageIsAnErrorOrAPart) {
  const std::string sound = DrilledBlockIges("MM", true);
  for (uint64_t i = 0; i < 12; ++i) {
    RandomStream random(i, 47);
    const std::string error = IgesError(Mutated(sound, random));
    EXPECT_TRUE(error == "accepted" || error.starts_with("part.igs")) << error;
  }
}

}  // namespace
}  // namespace millpose
