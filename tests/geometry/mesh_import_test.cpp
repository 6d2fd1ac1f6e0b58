// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/mesh_import.hpp"

#include <ctime>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

ImportResult Import(const Triangles& triangles, ImportOptions options = {}) {
  return ImportMesh({triangles, {}, {}}, options, "part.stl");
}

double Volume(const Mesh& mesh) {
  double volume = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    volume += mesh.Corner(f, 0).dot(mesh.Corner(f, 1).cross(mesh.Corner(f, 2))) / 6;
  return volume;
}

const Triangles kBox = BoxShape({0, 0, 0}, {10, 20, 30});

// A second import of what came out finds nothing to repair.
void ExpectNothingToRepair(const ImportResult& first) {
  const ImportResult again = Import(first.mesh.triangles(), {1, 0});
  EXPECT_EQ(again.report.triangles, first.report.triangles);
  EXPECT_EQ(again.report.repairs.flipped + again.report.repairs.duplicate + again.report.repairs.degenerate,
            0);
  EXPECT_EQ(again.report.repairs.turned_pieces, 0);
}

TEST(MeshImport, LeavesASoundMeshAlone) {
  const ImportResult result = Import(Soup(kBox));
  EXPECT_TRUE(Findings(result.report).empty());
  EXPECT_EQ(result.report.triangles, 12);
  EXPECT_EQ(result.report.vertices, 8);
  EXPECT_EQ(result.report.pieces, 1);
  EXPECT_EQ(result.report.closed_pieces, 1);
  EXPECT_EQ(result.report.upper, Eigen::Vector3d(10, 20, 30));
  EXPECT_NEAR(Volume(result.mesh), 6000, 1e-9);
}

TEST(MeshImport, AppliesTheUnit) {
  const ImportResult result = Import(Soup(BoxShape({0, 0, 0}, {1, 1, 1})), {25.4, 1e-4});
  EXPECT_NEAR(Volume(result.mesh), 25.4 * 25.4 * 25.4, 1e-9);
}

TEST(MeshImport, WeldsWithinTheToleranceAndNotBeyond) {
  Triangles soup = Soup(kBox);
  RandomStream random(1, 0);
  for (auto& p : soup.vertices)
    p += 2e-5 * Eigen::Vector3d{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
  const ImportResult result = Import(soup);
  EXPECT_EQ(result.report.vertices, 8);
  EXPECT_EQ(result.report.welded, 36 - 8);
  EXPECT_EQ(result.report.rims, 0);
  EXPECT_EQ(Import(soup, {1, 1e-7}).report.vertices, 36);
}

TEST(MeshImport, CountsDuplicatesOfAnyOrder) {
  Triangles mesh = kBox;
  mesh.faces.push_back(kBox.faces[3]);
  mesh.faces.push_back({kBox.faces[5][1], kBox.faces[5][0], kBox.faces[5][2]});
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.duplicate, 2);
  EXPECT_EQ(result.report.triangles, 12);
  EXPECT_EQ(result.report.closed_pieces, 1);
  ExpectNothingToRepair(result);
}

TEST(MeshImport, TurnsFlippedTriangles) {
  Triangles mesh = kBox;
  Flip(mesh, 2);
  Flip(mesh, 7);
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.flipped, 2);
  EXPECT_EQ(result.report.repairs.turned_pieces, 0);
  EXPECT_NEAR(Volume(result.mesh), 6000, 1e-9);
  ExpectNothingToRepair(result);
}

TEST(MeshImport, TurnsClosedPiecesOutsideOutAndKeepsCavities) {
  Triangles mesh = kBox;
  for (size_t f = 0; f < mesh.faces.size(); ++f) Flip(mesh, f);
  const ImportResult turned = Import(mesh);
  EXPECT_EQ(turned.report.repairs.turned_pieces, 1);
  EXPECT_EQ(turned.report.repairs.flipped, 0);
  EXPECT_NEAR(Volume(turned.mesh), 6000, 1e-9);

  Triangles hollow = kBox, cavity = BoxShape({2, 2, 2}, {4, 4, 4});
  for (size_t f = 0; f < cavity.faces.size(); ++f) Flip(cavity, f);
  Append(hollow, cavity);
  const ImportResult kept = Import(hollow);
  EXPECT_EQ(kept.report.repairs.turned_pieces, 0);
  EXPECT_EQ(kept.report.pieces, 2);
  EXPECT_NEAR(Volume(kept.mesh), 6000 - 8, 1e-9);
}

TEST(MeshImport, RemovesTrianglesWithoutAreaAndLeavesNoCrack) {
  // The top of the box is cut at a vertex on the middle of its diagonal; a flat triangle fills the crack.
  Triangles mesh = kBox;
  const int middle = 8;
  mesh.vertices.emplace_back(5, 10, 30);
  mesh.faces.erase(mesh.faces.begin() + 2);  // {4, 5, 7}
  mesh.faces.push_back({4, 5, middle});
  mesh.faces.push_back({5, 7, middle});
  mesh.faces.push_back({4, middle, 7});
  mesh.faces.push_back({1, 1, 2});
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.degenerate, 2);
  EXPECT_EQ(result.report.triangles, 14);
  EXPECT_EQ(result.report.rims, 0);
  EXPECT_NEAR(Volume(result.mesh), 6000, 1e-9);
  ExpectNothingToRepair(result);
}

TEST(MeshImport, CountsNoMoreFlatTrianglesThanThereWere) {
  // A part far below the tolerance (a wrong unit): most triangles are flat, splitting neighbours makes more.
  const ImportResult result = Import(SphereShape(0.002, 40));
  EXPECT_GT(result.report.repairs.degenerate, 0);
  EXPECT_LE(result.report.repairs.degenerate, result.report.triangles_read);
}

TEST(MeshImport, SaysWhatItFoundInPlainWords) {
  Triangles mesh = kBox;
  Flip(mesh, 3);
  mesh.faces.pop_back();
  const std::vector<std::string> expected{"1 triangle was turned to fit its neighbours",
                                          "1 open rim, 86.1 mm long; holes stay open"};
  EXPECT_EQ(Findings(Import(mesh).report), expected);
}

TEST(MeshImport, LeavesHolesOpenAndTellsThem) {
  Triangles mesh = kBox;
  mesh.faces.erase(mesh.faces.begin() + 2, mesh.faces.begin() + 4);  // the top
  mesh.faces.erase(mesh.faces.begin());                              // half the bottom
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.rims, 2);
  EXPECT_NEAR(result.report.rim_length, 60 + 30 + std::hypot(10, 20), 1e-9);
  EXPECT_EQ(result.report.closed_pieces, 0);
}

TEST(MeshImport, FlipsOpenSheetsAndNothingElse) {
  Triangles mesh = kBox;
  Append(mesh, Moved(GridShape(2, 2, 5), Eigen::Isometry3d(Eigen::Translation3d(100, 0, 0))));
  const Mesh plain = Import(mesh).mesh, flipped = Import(mesh, {.flip = true}).mesh;
  int turned = 0;
  for (int f = 0; f < plain.face_count(); ++f) {
    const bool sheet = plain.Corner(f, 0).x() > 50;
    EXPECT_NEAR(plain.FaceNormal(f).dot(flipped.FaceNormal(f)), sheet ? -1 : 1, 1e-12);
    turned += sheet;
  }
  EXPECT_EQ(turned, 8);
  EXPECT_THROW(Import(kBox, {.flip = true}), InputError);
}

TEST(MeshImport, TakesBodiesThatShareAnEdgeApart) {
  Triangles mesh = BoxShape({0, 0, 0}, {1, 1, 1});
  Append(mesh, BoxShape({1, 1, 0}, {2, 2, 1}));
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.non_manifold_edges, 1);
  EXPECT_EQ(result.report.repairs.non_manifold_vertices, 2);
  EXPECT_EQ(result.report.vertices, 16);
  EXPECT_EQ(result.report.pieces, 2);
  EXPECT_EQ(result.report.closed_pieces, 2);
  EXPECT_EQ(result.report.rims, 0);
  EXPECT_NEAR(Volume(result.mesh), 2, 1e-9);
}

TEST(MeshImport, CutsEdgesOfThreeSheets) {
  Triangles mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.non_manifold_edges, 1);
  EXPECT_EQ(result.report.pieces, 3);
  EXPECT_EQ(result.report.vertices, 9);
  EXPECT_EQ(result.report.rims, 3);
}

TEST(MeshImport, DoublesVerticesWhereFansMeet) {
  Triangles mesh = BoxShape({0, 0, 0}, {1, 1, 1});
  Append(mesh, BoxShape({1, 1, 1}, {2, 2, 2}));
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.non_manifold_vertices, 1);
  EXPECT_EQ(result.report.repairs.non_manifold_edges, 0);
  EXPECT_EQ(result.report.vertices, 16);
}

TEST(MeshImport, CutsAMoebiusBand) {
  const Triangles mesh = MoebiusShape();
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.not_orientable_edges, 1);
  EXPECT_EQ(result.report.triangles, 24);
  EXPECT_EQ(result.report.rims, 1);
}

// Every pair of triangles on the edge was looked at, by exact numbers where they lie in one plane: 20,000
// took 15 s.
TEST(MeshImport, AFanOnOneEdgeCostsInProportion) {
  const auto seconds = [](int count, bool flat) {
    Triangles fan;
    fan.vertices = {{0, 0, 0}, {0, 0, 10}};
    for (int i = 0; i < count; ++i) {
      const auto [s, c] = SinCos(2 * kPi * i / count);
      fan.vertices.emplace_back(flat ? Eigen::Vector3d(1 + 0.01 * i, 0, 5)
                                     : Eigen::Vector3d(50 * c, 50 * s, 5));
      fan.faces.push_back({0, 1, i + 2});
    }
    const std::clock_t start = std::clock();
    const ImportResult result = ImportMesh({fan, {}, {}}, {}, "fan.obj");
    EXPECT_EQ(result.report.triangles, static_cast<size_t>(count));
    EXPECT_EQ(result.report.repairs.non_manifold_edges, 1u);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  for (const bool flat : {false, true}) {
    const double few = std::min(seconds(1000, flat), seconds(1000, flat));
    EXPECT_LT(seconds(4000, flat), 8 * few + 0.1) << flat;  // four times as many; 16 times were it quadratic
  }
}

TEST(MeshImport, RefusesWhatHasNoArea) {
  Triangles mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2}};
  EXPECT_THROW(Import(mesh), InputError);
}

// What the report says of pieces and outside against the mesh, face by face.
void ExpectAgreement(const ImportResult& result) {
  const Mesh& mesh = result.mesh;
  std::vector<int> piece(mesh.face_count(), -1);
  size_t pieces = 0, closed_pieces = 0;
  double area = 0, closed_area = 0;
  for (int seed = 0; seed < mesh.face_count(); ++seed) {
    if (piece[seed] >= 0) continue;
    std::vector<int> faces{seed};
    piece[seed] = static_cast<int>(pieces++);
    bool closed = true;
    double own = 0;
    for (size_t head = 0; head < faces.size(); ++head) {
      const Eigen::Vector3d a = mesh.Corner(faces[head], 0);
      own += (mesh.Corner(faces[head], 1) - a).cross(mesh.Corner(faces[head], 2) - a).norm() / 2;
      for (int k = 0; k < 3; ++k) {
        const int next = mesh.Neighbour(faces[head], k);
        closed = closed && next >= 0;
        if (next < 0 || piece[next] >= 0) continue;
        piece[next] = piece[seed];
        faces.push_back(next);
      }
    }
    area += own;
    closed_pieces += closed ? 1 : 0;
    closed_area += closed ? own : 0;
  }
  EXPECT_EQ(result.report.pieces, pieces);
  EXPECT_EQ(result.report.closed_pieces, closed_pieces);
  EXPECT_NEAR(result.report.area, area, 1e-9 * area);
  EXPECT_NEAR(result.report.closed_area, closed_area, 1e-9 * area);
  EXPECT_EQ(result.report.rims > 0, closed_pieces < pieces);
}

TEST(MeshImport, ATouchingBodyIsNoCavity) {
  // Inside out under a larger body, its first face (the top) in the plane of that one's bottom.
  Triangles mesh = BoxShape({2, 2, -2}, {4, 4, 0});
  std::ranges::rotate(mesh.faces, mesh.faces.begin() + 2);
  for (size_t f = 0; f < mesh.faces.size(); ++f) Flip(mesh, f);
  Append(mesh, BoxShape({0, 0, 0}, {10, 10, 10}));
  const ImportResult result = Import(mesh);
  EXPECT_EQ(result.report.repairs.turned_pieces, 1);
  EXPECT_NEAR(Volume(result.mesh), 1008, 1e-9);
}

TEST(MeshImport, RepairsRandomSoupsIntoManifolds) {
  // Twelve vertices and many triangles among them: every defect at once. Mesh itself refuses what is no
  // manifold.
  for (uint64_t seed = 0; seed < 300; ++seed) {
    RandomStream random(seed, 7);
    Triangles mesh;
    for (int i = 0; i < 12; ++i)
      mesh.vertices.push_back({random.Uniform(0, 9), random.Uniform(0, 9), random.Uniform(0, 9)});
    const int count = 1 + random.Below(60);
    for (int i = 0; i < count; ++i)
      mesh.faces.push_back({random.Below(12), random.Below(12), random.Below(12)});
    mesh.faces.push_back({0, 1, 2});
    const ImportResult result = Import(mesh);
    EXPECT_LE(result.report.triangles + result.report.repairs.duplicate, mesh.faces.size());
    EXPECT_LE(result.report.repairs.degenerate, mesh.faces.size());
    ExpectAgreement(result);
    const ImportResult again = Import(result.mesh.triangles(), {1, 0});
    EXPECT_EQ(again.report.triangles, result.report.triangles);
  }
}

TEST(MeshImport, CallsOutWrongUnits) {
  EXPECT_FALSE(UnitWarning(900, 2800));
  EXPECT_FALSE(UnitWarning(6200, 2800));
  EXPECT_EQ(UnitWarning(0.9, 2800).value(),
            "the part is 0.9 mm long, the arm reaches 2800 mm; it would fit if it were 1000 times larger "
            "(metres given "
            "as mm?)");
  EXPECT_NE(UnitWarning(900000, 2800).value().find("1000 times smaller"), std::string::npos);
  EXPECT_NE(UnitWarning(22, 2800).value().find("25.4 times larger"), std::string::npos);
  EXPECT_NE(UnitWarning(1e9, 2800).value().find("check the unit"), std::string::npos);
}

}  // namespace
}  // namespace millpose
