// SPDX-License-Identifier: GPL-3.0-or-later
// Closed in, closed out: whatever a repair does to slivers, T-junctions and doubled vertices, it opens
// nothing.
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/weld.hpp"
#include "tests/base/tier.hpp"
#include "tests/geometry/damaged_meshes.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

TEST(ClosedRepair, OpensNothing) {
  const int meshes = OfTier(300, 10000);
  int sound = 0, split = 0, flat = 0;
  for (int i = 0; i < meshes; ++i) {
    const DamagedMesh damaged = MakeDamagedMesh(i);
    // The weld may take apart what it should join where copies of a vertex lie on both sides of its
    // tolerance.
    const auto vertices = [](const Triangles& mesh) {
      return Weld(mesh, kDamageWeld, nullptr).vertices.size();
    };
    if (vertices(damaged.mesh) != vertices(damaged.indexed)) continue;
    ++sound;
    const ImportResult result = ImportMesh({damaged.mesh, {}, {}}, {1, kDamageWeld}, "part.stl");
    const ImportReport& report = result.report;
    EXPECT_EQ(report.rims, 0) << "mesh " << i << ": " << report.rim_length << " mm open; "
                              << fmt::format("{}", fmt::join(Findings(report), "; "));
    EXPECT_EQ(report.closed_pieces, report.pieces) << "mesh " << i;
    EXPECT_NEAR(Volume(result.mesh.triangles()), damaged.volume, 1e-2 * damaged.volume) << "mesh " << i;
    split += report.repairs.t_junctions > 0 ? 1 : 0;
    flat += report.repairs.degenerate > 0 ? 1 : 0;
  }
  EXPECT_GT(sound, meshes * 0.999);
  EXPECT_GT(split, meshes / 3);
  EXPECT_GT(flat, meshes / 3);
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
