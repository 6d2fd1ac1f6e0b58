// SPDX-License-Identifier: GPL-3.0-or-later
// Closed in, closed out: whatever a repair does to slivers, T-junctions and doubled vertices, it opens
// nothing.
#include "base/random.hpp"
#include "surface/edges.hpp"
#include "surface/mesh_import.hpp"
#include "surface/weld.hpp"
#include "tests/base/tier.hpp"
#include "tests/surface/shapes.hpp"

namespace millpose {
namespace {

constexpr double kWeld = 1e-4;  // mm, the default

double Volume(const Triangles& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.faces)
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  return volume;
}

Eigen::Vector3d Offset(RandomStream& random, double size) {
  return size * Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
}

bool IsClosed(const Triangles& mesh) {
  bool closed = true;
  ForEachEdge(SortedSides(mesh),
              [&](size_t begin, size_t end) { closed = closed && (end - begin) % 2 == 0; });
  return closed;
}

/// Damages that keep a mesh closed: what tessellators and file formats leave.
class Damage {
 public:
  Damage(Triangles& mesh, RandomStream& random) : mesh_(mesh), random_(random) {}

  void Any() {
    switch (random_.Below(4)) {
      case 0:
        return Sliver(random_.Uniform(0.1, 0.9));
      case 1:  // next to the end of the edge: a vertex that the weld joins
        return Sliver(random_.Uniform(0, 1) < 0.5 ? 1e-7 : 1 - 1e-7);
      case 2:
        return Star(random_.Uniform(0, 1) < 0.5 ? 1e-6 : 0.4);
      default:
        return Turned();
    }
  }

 private:
  /// A vertex beside the edge of a face, within the weld tolerance of it: the face is split there, and a
  /// triangle without area fills the crack to the neighbour, which keeps the whole edge (a T-junction,
  /// filled).
  void Sliver(double share) {
    const int face = random_.Below(static_cast<int>(mesh_.faces.size())), side = random_.Below(3);
    auto f = mesh_.faces[face];
    std::rotate(f.begin(), f.begin() + side, f.end());
    const Eigen::Vector3d &a = mesh_.vertices[f[0]], &b = mesh_.vertices[f[1]];
    const int middle = static_cast<int>(mesh_.vertices.size());
    const Eigen::Vector3d at = a + share * (b - a) + Offset(random_, 0.3 * kWeld);
    mesh_.vertices.push_back(at);
    mesh_.faces[face] = {f[0], middle, f[2]};
    mesh_.faces.push_back({middle, f[1], f[2]});
    mesh_.faces.push_back({f[0], f[1], middle});
  }

  /// A vertex in a face, perhaps next to one of its corners.
  void Star(double weight) {
    const int face = random_.Below(static_cast<int>(mesh_.faces.size()));
    const auto f = mesh_.faces[face];
    const int middle = static_cast<int>(mesh_.vertices.size());
    mesh_.vertices.emplace_back((1 - 2 * weight) * mesh_.vertices[f[0]] + weight * mesh_.vertices[f[1]] +
                                weight * mesh_.vertices[f[2]]);
    mesh_.faces[face] = {f[0], f[1], middle};
    mesh_.faces.push_back({f[1], f[2], middle});
    mesh_.faces.push_back({f[2], f[0], middle});
  }

  /// A triangle turned round.
  void Turned() {
    if (random_.Uniform() < 0.1) Flip(mesh_, random_.Below(static_cast<int>(mesh_.faces.size())));
  }

  Triangles& mesh_;
  RandomStream& random_;
};

Triangles Shape(RandomStream& random) {
  switch (random.Below(4)) {
    case 0:
      return BoxShape({0, 0, 0}, {30, 20, 10});
    case 1:
      return SphereShape(15, 4 + random.Below(3));
    case 2:
      return CylinderShape(8, 40, 5 + random.Below(6), 1 + random.Below(2));
    default: {
      Triangles two = BoxShape({0, 0, 0}, {10, 10, 10});  // two bodies with a common edge
      Append(two, BoxShape({10, 10, 0}, {20, 20, 10}));
      return two;
    }
  }
}

TEST(ClosedRepair, OpensNothing) {
  const int meshes = OfTier(300, 10000);
  int closed = 0, repaired = 0;
  for (int i = 0; i < meshes; ++i) {
    RandomStream random(31, static_cast<uint64_t>(i));
    Triangles mesh = Shape(random);
    const double volume = std::abs(Volume(mesh));
    Damage damage(mesh, random);
    for (int k = random.Below(12); k > 0; --k) damage.Any();
    if (random.Uniform() < 0.5) {
      mesh = Soup(mesh);
      for (Eigen::Vector3d& p : mesh.vertices) p += Offset(random, 1e-3 * kWeld);  // rounding of a file
    }
    if (!IsClosed(Weld(mesh, kWeld, nullptr))) continue;  // the weld took apart what it should have joined
    ++closed;
    const ImportResult result = ImportMesh({mesh, {}, {}}, {1, kWeld}, "part.stl");
    const ImportReport& report = result.report;
    EXPECT_EQ(report.rims, 0) << "mesh " << i << ": " << report.rim_length << " mm open; "
                              << fmt::format("{}", fmt::join(Findings(report), "; "));
    EXPECT_EQ(report.closed_pieces, report.pieces) << "mesh " << i;
    EXPECT_NEAR(Volume(result.mesh.triangles()), volume, 1e-2 * volume) << "mesh " << i;
    repaired += report.repairs.degenerate > 0 ? 1 : 0;
  }
  EXPECT_GT(closed, meshes * 0.999);
  EXPECT_GT(repaired, meshes / 3);
}

TEST(ClosedRepair, AFlapLeavesTheBodyClosedAndOutsideCertain) {
  Triangles mesh = BoxShape({0, 0, 0}, {10, 20, 30});
  for (size_t f = 0; f < mesh.faces.size(); ++f) Flip(mesh, static_cast<int>(f));
  const std::array<int, 3> face = mesh.faces[0];
  mesh.vertices.emplace_back(-5, -5, -5);
  mesh.faces.push_back({face[0], face[1], static_cast<int>(mesh.vertices.size()) - 1});
  const ImportResult result = ImportMesh({mesh, {}, {}}, {}, "part.stl");
  EXPECT_EQ(result.report.pieces, 2);
  EXPECT_EQ(result.report.closed_pieces, 1);
  EXPECT_EQ(result.report.repairs.turned_pieces, 1);
  EXPECT_EQ(result.report.rims, 1);
}

TEST(ClosedRepair, AnEdgeOfTwoBodiesStopsNoOrientation) {
  Triangles mesh = BoxShape({0, 0, 0}, {1, 1, 1}), inside_out = BoxShape({1, 1, 0}, {2, 2, 1});
  for (size_t f = 0; f < inside_out.faces.size(); ++f) Flip(inside_out, static_cast<int>(f));
  Append(mesh, inside_out);
  const ImportResult result = ImportMesh({mesh, {}, {}}, {}, "part.stl");
  EXPECT_EQ(result.report.closed_pieces, 2);
  EXPECT_EQ(result.report.repairs.turned_pieces, 1);
  EXPECT_NEAR(Volume(result.mesh.triangles()), 2, 1e-9);
}

TEST(ClosedRepair, AWallWithoutThicknessGoesAltogether) {
  // Two boxes with a common wall, each closed: the wall's triangles are back to back.
  Triangles mesh = BoxShape({0, 0, 0}, {10, 10, 10});
  Append(mesh, BoxShape({10, 0, 0}, {20, 10, 10}));
  const ImportResult result = ImportMesh({mesh, {}, {}}, {}, "part.stl");
  EXPECT_EQ(result.report.rims, 0);
  EXPECT_NEAR(Volume(result.mesh.triangles()), 2000, 1e-9);
}

}  // namespace
}  // namespace millpose
