// SPDX-License-Identifier: GPL-3.0-or-later
// One mesh per defect of shape, in every format, with everything that the import must find in it.
#include "base/random.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/geometry/formats.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

/// What an import must report; what is not named is 0.
struct Expected {
  size_t triangles = 12, vertices = 8, pieces = 1, closed = 1;
  size_t rims = 0, degenerate = 0, duplicate = 0, flipped = 0, turned = 0, crossings = 0;
  size_t edges = 0, fans = 0, not_orientable = 0, welded = 0;
};

struct Defect {
  std::string name;
  PolygonMesh mesh;
  Expected expected;
  double unit = 1;
  std::vector<std::string> formats{};  ///< only these, where a format cannot hold the defect; all when empty
};

const Triangles kBlock = BoxShape({0, 0, 0}, {10, 20, 30});

template <class Change>
PolygonMesh Changed(Change change, Triangles mesh = kBlock) {
  change(mesh);
  return Polygons(mesh);
}

Triangles Joined(Triangles a, const Triangles& b) {
  Append(a, b);
  return a;
}

Triangles Inverted(Triangles mesh) {
  for (size_t f = 0; f < mesh.faces.size(); ++f) Flip(mesh, f);
  return mesh;
}

// The box's top {4, 5, 7}, {4, 7, 6} cut at a vertex on its diagonal, the crack filled by a flat triangle.
Triangles FlatFiller() {
  Triangles mesh = kBlock;
  mesh.vertices.emplace_back(5, 10, 30);
  std::erase(mesh.faces, std::array<int, 3>{4, 5, 7});
  mesh.faces.insert(mesh.faces.end(), {{4, 5, 8}, {5, 7, 8}, {4, 8, 7}});
  return mesh;
}

std::vector<Defect> Closed() {
  const Eigen::Vector3d far(1e5, -2e5, 3e5);
  RandomStream random(3, 0);
  Triangles jitter = Soup(kBlock), metres = kBlock, away = kBlock;
  for (auto& p : jitter.vertices)
    p += 2e-5 * Eigen::Vector3d{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
  for (auto& p : metres.vertices) p /= 1000;
  for (auto& p : away.vertices) p += far;
  Triangles cavity = Joined(kBlock, Inverted(BoxShape({2, 2, 2}, {4, 4, 4})));
  return {
      {"sound", Polygons(kBlock), {}},
      {"every triangle on its own", Polygons(Soup(kBlock)), {}},
      {"one triangle turned", Changed([](Triangles& m) { Flip(m, 4); }), {.flipped = 1}},
      {"five triangles turned",
       Changed([](Triangles& m) {
         for (const size_t f : {0, 3, 5, 8, 11}) Flip(m, f);
       }),
       {.flipped = 5}},
      {"inside out", Polygons(Inverted(kBlock)), {.turned = 1}},
      {"inside out but for one",
       Changed([](Triangles& m) { Flip(m, 4); }, Inverted(kBlock)),
       {.flipped = 1, .turned = 1}},
      {"a triangle twice", Changed([](Triangles& m) { m.faces.push_back(m.faces[3]); }), {.duplicate = 1}},
      {"a triangle twice, turned",
       Changed([](Triangles& m) {
         m.faces.push_back({m.faces[3][1], m.faces[3][0], m.faces[3][2]});
       }),
       {.duplicate = 1}},
      {"the whole part twice", Polygons(Joined(kBlock, kBlock)), {.duplicate = 12}},
      {"a corner twice",
       Changed([](Triangles& m) {
         m.faces.push_back({1, 1, 2});
       }),
       {.degenerate = 1}},
      {"a triangle that is a point",
       Changed([](Triangles& m) {
         m.faces.push_back({5, 5, 5});
       }),
       {.degenerate = 1}},
      {"a flat triangle in a crack",
       Polygons(FlatFiller()),
       {.triangles = 14, .vertices = 9, .degenerate = 1}},
      {"vertices that jitter",
       Polygons(jitter),
       {.welded = 28},
       1,
       {"stl text", "obj", "off", "ply", "ply little", "ply big"}},
      {"metres", Polygons(metres), {}, 1000},
      {"far from the origin", Polygons(away), {}},
      {"vertices that nobody uses",
       Changed([](Triangles& m) {
         m.vertices.insert(m.vertices.begin() + 8, 5, {99, 99, 99});
       }),
       {}},
      {"two boxes apart",
       Polygons(Joined(kBlock, BoxShape({50, 0, 0}, {60, 9, 9}))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2}},
      {"a cavity", Polygons(cavity), {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2}},
      {"a cavity and its part inside out",
       Polygons(Joined(Inverted(kBlock), Inverted(BoxShape({2, 2, 2}, {4, 4, 4})))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2, .turned = 1}},
      {"two boxes with an edge in common",
       Polygons(Joined(kBlock, BoxShape({10, 20, 0}, {20, 40, 30}))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2, .edges = 1, .fans = 2}},
      {"two boxes with a corner in common",
       Polygons(Joined(kBlock, BoxShape({10, 20, 30}, {20, 30, 40}))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2, .fans = 1}},
      // Each wall is met in one of its triangles, by the eight of the bar's sides; a box that touches it adds
      // its two of the end.
      {"a bar through the part",
       Polygons(Joined(kBlock, BoxShape({-5, 12, 2}, {15, 14, 4}))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2, .crossings = 16}},
      {"two boxes that touch",
       Polygons(Joined(kBlock, BoxShape({10, 12, 2}, {20, 14, 4}))),
       {.triangles = 24, .vertices = 16, .pieces = 2, .closed = 2, .crossings = 10}}};
}

std::vector<Defect> Open() {
  Triangles strip;  // folded onto itself over its middle edge
  strip.vertices = {{0, 0, 0}, {10, 0, 0}, {5, 8, 0}, {4, 6, 0}};
  strip.faces = {{0, 1, 2}, {1, 0, 3}};
  Triangles sheets;
  sheets.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  sheets.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  Triangles soup;
  for (int i = 0; i < 7; ++i) {
    for (const auto& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(8, 0, 1), Eigen::Vector3d(0, 8, 2)})
      soup.vertices.push_back(p + Eigen::Vector3d(10 * i, 0, 0));
    soup.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Triangles gap = Soup(GridShape(2, 1, 10));
  for (size_t v = 0; v < gap.vertices.size(); ++v)
    if (v >= 6) gap.vertices[v].x() += 1e-3;  // ten times the tolerance
  Triangles sliver = GridShape(1, 1, 10);
  sliver.vertices.emplace_back(5, -5e-5, 0);
  sliver.faces.push_back({0, 4, 1});
  return {
      {"one triangle",
       Changed([](Triangles& m) { m.faces.resize(1); }),
       {.triangles = 1, .vertices = 3, .closed = 0, .rims = 1}},
      {"a triangle missing",
       Changed([](Triangles& m) { m.faces.pop_back(); }),
       {.triangles = 11, .closed = 0, .rims = 1}},
      {"two holes",
       Changed([](Triangles& m) {
         m.faces.erase(m.faces.begin() + 2, m.faces.begin() + 4);
         m.faces.erase(m.faces.begin());
       }),
       {.triangles = 9, .closed = 0, .rims = 2}},
      {"a Möbius band",
       Polygons(MoebiusShape()),
       {.triangles = 24,
        .vertices = 26,
        .closed = 0,
        .rims = 1,
        .flipped = 12,
        .fans = 2,
        .not_orientable = 1}},
      {"three sheets at an edge",
       Polygons(sheets),
       {.triangles = 3, .vertices = 9, .pieces = 3, .closed = 0, .rims = 3, .edges = 1, .fans = 2}},
      {"a fold", Polygons(strip), {.triangles = 2, .vertices = 4, .closed = 0, .rims = 1, .crossings = 1}},
      {"a soup", Polygons(soup), {.triangles = 7, .vertices = 21, .pieces = 7, .closed = 0, .rims = 7}},
      {"a gap above the tolerance",
       Polygons(gap),
       {.triangles = 4, .vertices = 8, .pieces = 2, .closed = 0, .rims = 2}},
      {"a sliver below the tolerance",
       Polygons(sliver),
       {.triangles = 3, .vertices = 5, .closed = 0, .rims = 1, .degenerate = 1}},
      {"a scan: open, coarse",
       Polygons(GridShape(5, 4, 3)),
       {.triangles = 40, .vertices = 30, .closed = 0, .rims = 1}}};
}

// Faces of more corners; STL has none.
std::vector<Defect> OfPolygons() {
  PolygonMesh squares{kBlock.vertices,
                      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  PolygonMesh concave{{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {5, 2, 0}, {0, 10, 0}}, {{0, 1, 2, 3, 4}}};
  PolygonMesh digon{kBlock.vertices, {{0, 1}}};
  for (const auto& [a, b, c] : kBlock.faces) digon.faces.push_back({a, b, c});
  const std::vector<std::string> formats{"obj", "off", "ply", "ply little", "ply big"};
  return {{"squares", squares, {}, 1, formats},
          {"a concave polygon", concave, {.triangles = 3, .vertices = 5, .closed = 0, .rims = 1}, 1, formats},
          {"a face of two corners", digon, {}, 1, {"off", "ply", "ply little", "ply big"}}};
}

void ExpectReport(const ImportReport& report, const Expected& expected) {
  EXPECT_EQ(report.triangles, expected.triangles);
  EXPECT_EQ(report.vertices, expected.vertices);
  EXPECT_EQ(report.pieces, expected.pieces);
  EXPECT_EQ(report.closed_pieces, expected.closed);
  EXPECT_EQ(report.rims, expected.rims);
  EXPECT_EQ(report.repairs.degenerate, expected.degenerate);
  EXPECT_EQ(report.repairs.duplicate, expected.duplicate);
  EXPECT_EQ(report.repairs.flipped, expected.flipped);
  EXPECT_EQ(report.repairs.turned_pieces, expected.turned);
  EXPECT_EQ(report.crossings.pairs, expected.crossings);
  EXPECT_TRUE(report.crossings.complete);
  EXPECT_EQ(report.repairs.non_manifold_edges, expected.edges);
  EXPECT_EQ(report.repairs.non_manifold_vertices, expected.fans);
  EXPECT_EQ(report.repairs.not_orientable_edges, expected.not_orientable);
  EXPECT_EQ(report.welded, expected.welded);
}

// What came out, written and read again, comes out as it went in; what is told then is its shape alone.
void ExpectIdempotent(const ImportResult& first) {
  const Triangles& done = first.mesh.triangles();
  for (const auto& [format, bytes] : InAllFormats(Polygons(done))) {
    if (format.starts_with("stl")) continue;  // rounds to floats, and loses which vertices are apart
    SCOPED_TRACE("again as " + format);
    const ImportResult again = ImportMesh(ReadMesh(bytes, "again"), {1, 0}, "again");
    const RepairCounts& repairs = again.report.repairs;
    EXPECT_EQ(repairs.flipped + repairs.duplicate + repairs.degenerate + repairs.turned_pieces, 0u);
    EXPECT_EQ(again.report.welded, 0u);
    EXPECT_EQ(again.report.triangles, first.report.triangles);
    EXPECT_EQ(again.report.vertices, first.report.vertices);
    EXPECT_EQ(again.report.rims, first.report.rims);
    EXPECT_EQ(again.report.crossings.pairs, first.report.crossings.pairs);
    for (int f = 0; f < first.mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) EXPECT_EQ(again.mesh.Corner(f, k), first.mesh.Corner(f, k));
  }
}

TEST(Corpus, EveryDefectOfShapeIsFoundInEveryFormat) {
  size_t files = 0;
  for (const auto& list : {Closed(), Open(), OfPolygons()})
    for (const Defect& defect : list)
      for (const auto& [format, bytes] : InAllFormats(defect.mesh)) {
        if (!defect.formats.empty() && std::ranges::find(defect.formats, format) == defect.formats.end())
          continue;
        SCOPED_TRACE(defect.name + ", " + format);
        ++files;
        const ImportResult result = ImportMesh(ReadMesh(bytes, "part"), {defect.unit, 1e-4}, "part");
        ExpectReport(result.report, defect.expected);
        if (format == "off") ExpectIdempotent(result);
      }
  EXPECT_GT(files, 200u);
}

}  // namespace
}  // namespace millpose
