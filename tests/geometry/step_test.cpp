// SPDX-License-Identifier: GPL-3.0-or-later
// STEP parts, made by OpenCASCADE here and read by millpose-step.
#include <sys/stat.h>

#include <filesystem>
#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/units.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/mesh_parts.hpp"
#include "geometry/import/step_reader.hpp"
#include "tests/base/refusal.hpp"
#include "tests/geometry/mutate.hpp"
#include "tests/geometry/step_parts.hpp"
#include "toolpath/region.hpp"

namespace millpose {
namespace {

StepOptions Options(double chord_tolerance = 0.05) {
  StepOptions options;
  options.chord_tolerance = chord_tolerance;
  options.program = MILLPOSE_STEP_PROGRAM;
  return options;
}

std::string StepError(const std::string& bytes, const StepOptions& options) {
  return RefusalOf([&] { ReadMesh(bytes, "part.step", options); });
}

double AreaOfFace(const Mesh& mesh, int source) {
  double area = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (source < 0 || mesh.triangles().source[f] == source)
      area += (mesh.Corner(f, 1) - mesh.Corner(f, 0)).cross(mesh.Corner(f, 2) - mesh.Corner(f, 0)).norm() / 2;
  return area;
}

ImportResult Imported(const std::string& bytes, double unit, double chord_tolerance = 0.05) {
  return ImportMesh(ReadMesh(bytes, "part.step", Options(chord_tolerance)), {unit, 1e-4}, "part.step");
}

TEST(Step, PartsInMillimetresAndInchesAreTheSame) {
  for (const auto& [name, unit] : {std::pair("MM", 1.0), std::pair("INCH", 25.4)}) {
    const ImportResult import = Imported(DrilledBlockStep(name), unit);
    EXPECT_EQ(import.report.rims, 0u) << name;
    EXPECT_EQ(import.report.pieces, 1u);
    EXPECT_EQ(import.report.closed_pieces, 1u);
    EXPECT_EQ(import.report.repairs.flipped + import.report.repairs.turned_pieces, 0u);
    EXPECT_LT((import.report.lower - Eigen::Vector3d(0, 0, 0)).norm(), 1e-6);
    EXPECT_LT((import.report.upper - Eigen::Vector3d(100, 60, 20)).norm(), 1e-6);
    const auto& faces = import.mesh.triangles().source_faces;
    ASSERT_EQ(faces.size(), 7u);
    std::set<std::string> ids;
    for (size_t i = 0; i < faces.size(); ++i) {
      ids.insert(faces[i].id);
      const double area = AreaOfFace(import.mesh, static_cast<int>(i));
      if (faces[i].kind == "cylinder") {
        EXPECT_NEAR(faces[i].area, 2 * kPi * 15 * 20, 1e-3);
        EXPECT_LT(area, faces[i].area);
        EXPECT_GT(area, 0.995 * faces[i].area);
      } else {
        EXPECT_EQ(faces[i].kind, "plane");
        EXPECT_NEAR(area, faces[i].area, 0.01 * faces[i].area);
      }
    }
    EXPECT_EQ(ids.size(), 7u);
  }
}

TEST(Step, BodiesOfAnAssemblyKeepTheirNamesAndStayApart) {
  const ImportResult import = Imported(AssemblyStep(), 1);
  const ImportReport& report = import.report;
  ASSERT_EQ(report.bodies.size(), 3u);
  const std::array<std::string, 3> names{"plate", "rib", "rib (2)"};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(report.bodies[i].name, names[i]);
    EXPECT_EQ(report.bodies[i].pieces, 1u) << names[i];
    EXPECT_EQ(report.bodies[i].closed_pieces, 1u) << names[i];
  }
  EXPECT_NEAR(report.bodies[0].area, 2 * (6000 + 1000 + 600), 1e-6);
  EXPECT_NEAR(report.bodies[2].area, 2 * (600 + 300 + 1800), 1e-6);
  EXPECT_EQ(report.pieces, 3u);
  EXPECT_EQ(report.closed_pieces, 3u);
  EXPECT_EQ(report.rims, 0u);
  EXPECT_EQ(report.crossings.pairs, 0u) << "they touch";
  EXPECT_EQ(Findings(report), std::vector<std::string>{
                                  "3 unconnected pieces, 3 of them closed; 3 bodies: plate, rib, rib (2)"});
  // Each face is its body's: the ribs' lie above the plate.
  ASSERT_EQ(report.body_of_source.size(), 18u);
  for (int f = 0; f < import.mesh.face_count(); ++f) {
    const Eigen::Vector3d middle =
        (import.mesh.Corner(f, 0) + import.mesh.Corner(f, 1) + import.mesh.Corner(f, 2)) / 3;
    const int body = report.body_of_source[static_cast<size_t>(import.mesh.triangles().source[f])];
    if (middle.z() < 10 - 1e-6) {
      EXPECT_EQ(body, 0);
    } else if (middle.z() > 10 + 1e-6) {
      EXPECT_EQ(body, middle.x() < 30 ? 1 : 2);
    }
  }
  EXPECT_EQ(Imported(DrilledBlockStep("MM"), 1).report.bodies.size(), 1u);
}

TEST(Step, TheFilesUnitMustBeTheJobs) {
  const RawMesh raw = ReadMesh(DrilledBlockStep("INCH"), "part.step", Options());
  EXPECT_EQ(raw.stated_unit, 25.4);
  try {
    ImportMesh(raw, {1.0, 1e-4}, "part.step");
    FAIL() << "the unit was let pass";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "part.step: the file states that its unit is 25.4 mm, given 1 mm");
  }
}

TEST(Step, ChordsKeepTheirTolerance) {
  int before = 0;
  for (const double tolerance : {0.5, 0.1, 0.03}) {
    const Mesh mesh = Imported(BallStep(20), 1, tolerance).mesh;
    double deepest = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Eigen::Vector3d centre = (mesh.Corner(f, 0) + mesh.Corner(f, 1) + mesh.Corner(f, 2)) / 3;
      deepest = std::max(deepest, 20 - centre.norm());
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(mesh.Corner(f, k).norm(), 20, 1e-6);
      EXPECT_GT(mesh.FaceNormal(f).dot(centre.normalized()), 0.9) << "outside is out";
    }
    EXPECT_LE(deepest, tolerance);
    EXPECT_GT(mesh.face_count(), before);
    before = mesh.face_count();
  }
}

TEST(Step, FacesAreRegionsByNumberIdAndName) {
  const Mesh mesh = Imported(DrilledBlockStep("MM"), 1).mesh;
  const auto& faces = mesh.triangles().source_faces;
  const auto hole =
      static_cast<int>(std::ranges::find(faces, std::string("cylinder"), &SourceFace::kind) - faces.begin());
  for (const std::string& name : {std::to_string(hole + 1), faces[hole].id}) {
    RegionOptions options;
    options.source_faces = {name};
    const Region region(mesh, options);
    for (int f = 0; f < mesh.face_count(); ++f)
      EXPECT_EQ(region.HasFace(f), mesh.triangles().source[f] == hole) << name;
  }
  RegionOptions options;
  options.source_faces = {"8", "hole"};
  try {
    const Region region(mesh, options);
    FAIL() << "unknown faces were let pass";
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 2u);
    EXPECT_EQ(error.problems()[0].message.substr(0, 55),
              "toolpath: the part has no STEP face \"8\"; there are 1 to");
  }
}

TEST(Step, FacesAreRegionsByAPlaceOnThem) {
  const Mesh mesh = Imported(DrilledBlockStep("MM"), 1).mesh;
  const Triangles& triangles = mesh.triangles();
  const MeshParts parts = FindMeshParts(mesh);
  for (size_t i = 0; i < parts.faces.size(); ++i) {
    const Eigen::Vector3d& at = parts.faces[i].place;
    RegionOptions options;
    options.source_faces = {fmt::format("near {:.2f} {:.2f} {:.2f}", at.x(), at.y(), at.z())};
    const Region region(mesh, options);
    for (int f = 0; f < mesh.face_count(); ++f)
      EXPECT_EQ(region.HasFace(f), triangles.source[f] == static_cast<int>(i)) << options.source_faces[0];
    // A cylinder's radius is that of the solid model.
    EXPECT_EQ(parts.faces[i].radius > 0, triangles.source_faces[i].kind == "cylinder");
  }
  const auto refusal = [&](const std::string& name) {
    RegionOptions options;
    options.source_faces = {name};
    return RefusalOf([&] { const Region region(mesh, options); });
  };
  EXPECT_NE(refusal("near 1000 0 0").find("mm away; allowed: at most 1 mm"), std::string::npos)
      << refusal("near 1000 0 0");
  const Eigen::Vector3d& edge = parts.edges.front().place;
  const std::string at_edge = refusal(fmt::format("near {} {} {}", edge.x(), edge.y(), edge.z()));
  EXPECT_NE(at_edge.find("is at the edge of faces"), std::string::npos) << at_edge;
  EXPECT_NE(refusal("near 1 2").find("no STEP face"), std::string::npos);
}

TEST(Step, RepairsKeepTheFacesOfTriangles) {
  RawMesh raw;
  Triangles& t = raw.triangles;
  // Two triangles of face 0 with a flat one of face 1 between them and one of face 2 twice.
  t.vertices = {{0, 0, 0}, {10, 0, 0}, {5, 0, 0}, {5, 8, 0}, {5, -8, 0}, {20, 0, 0}, {30, 0, 0}, {20, 9, 0}};
  t.faces = {{0, 1, 3}, {0, 2, 1}, {0, 4, 2}, {2, 4, 1}, {5, 6, 7}, {5, 6, 7}};
  t.source = {0, 1, 0, 0, 2, 2};
  t.source_faces.resize(3);
  const ImportResult import = ImportMesh(raw, {}, "part");
  const Triangles& done = import.mesh.triangles();
  ASSERT_EQ(done.source.size(), done.faces.size());
  EXPECT_EQ(std::ranges::count(done.source, 0), 4);  // the neighbour of the flat triangle was split
  EXPECT_EQ(std::ranges::count(done.source, 1), 0);
  EXPECT_EQ(std::ranges::count(done.source, 2), 1);
}

TEST(Step, WhatCannotBeReadIsAnError) {
  const std::string sound = DrilledBlockStep("MM");
  EXPECT_EQ(StepError("ISO-10303-21;\nrubbish", Options()).substr(0, 11), "part.step: ");
  for (const double share : {0.1, 0.5, 0.9}) {
    const std::string cut = sound.substr(0, static_cast<size_t>(share * static_cast<double>(sound.size())));
    EXPECT_EQ(StepError(cut, Options()).substr(0, 11), "part.step: ") << share;
  }
  StepOptions nothing = Options();
  nothing.program = "/no/such/program";
  EXPECT_NE(StepError(sound, nothing).find("cannot be started"), std::string::npos);
}

TEST(Step, LimitsAndCrashesAreTold) {
#if defined(MILLPOSE_SANITIZED)
  GTEST_SKIP() << "the address sanitizer reserves terabytes, so there is no limit of memory";
#endif
  StepOptions small = Options();
  small.memory_MB = 160;  // little more than the libraries
  small.chord_tolerance = 1e-4;
  EXPECT_EQ(StepError(BallStep(5000), small),
            "part.step: reading the STEP file takes more than 160 MB of memory");
  StepOptions quick = Options(1e-4);
  quick.seconds = 1;
  EXPECT_EQ(StepError(BallStep(20000), quick), "part.step: reading the STEP file took more than 1 s");
  const auto script = std::filesystem::temp_directory_path() / "millpose_step_crash.sh";
  WriteFileAtomically(script, "#!/bin/sh\nkill -SEGV $$\n");
  ::chmod(script.c_str(), 0700);
  StepOptions crash = Options();
  crash.program = script;
  EXPECT_EQ(StepError(BallStep(1), crash), "part.step: the STEP reader crashed on this file (signal 11)");
  std::filesystem::remove(script);
}

TEST(Step, DamagedAnswersAreRefused) {
  RawMesh mesh;
  mesh.triangles.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.faces = {{0, 1, 2}};
  mesh.triangles.source = {0};
  mesh.triangles.source_faces = {{"#12", "top side", "plane", 0.5, true, {1, 2, 3}, {4, 5, 6}}};
  mesh.notes = {"a note"};
  mesh.stated_unit = 25.4;
  const std::string bytes = WriteStepTriangles(mesh);
  const RawMesh read = ReadStepTriangles(bytes, "x");
  EXPECT_EQ(read.triangles.vertices, mesh.triangles.vertices);
  EXPECT_EQ(read.triangles.source_faces[0].name, "top side");
  EXPECT_TRUE(read.triangles.source_faces[0].lost);
  EXPECT_EQ(read.triangles.source_faces[0].upper, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(read.notes, mesh.notes);
  EXPECT_EQ(read.stated_unit, 25.4);
  for (uint64_t i = 0; i < 3000; ++i) {
    RandomStream random(i, 31);
    try {
      const RawMesh spoilt = ReadStepTriangles(Mutated(bytes, random), "x");
      for (const auto& face : spoilt.triangles.faces)
        for (const int v : face) ASSERT_LT(static_cast<size_t>(v), spoilt.triangles.vertices.size());
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace millpose
