// SPDX-License-Identifier: GPL-3.0-or-later
// Our repair and CGAL's functions on the meshes of ClosedRepair.OpensNothing: how many come out closed and
// with their volume. docs/decisions/0042-mesh-repair.md.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include "geometry/import/mesh_import.hpp"
#include "geometry/import/t_junctions.hpp"
#include "geometry/import/weld.hpp"
#include "tests/geometry/damaged_meshes.hpp"

namespace millpose {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr uint64_t kMeshes = 10000;

struct Tally {
  int open = 0, wrong_volume = 0, failed = 0;
  void Add(bool closed, double volume, double wanted) {
    open += closed ? 0 : 1;
    wrong_volume += closed && std::abs(volume - wanted) > 1e-2 * wanted ? 1 : 0;
  }
  void Tell(benchmark::State& state) const {
    state.counters["open"] = open;
    state.counters["wrong_volume"] = wrong_volume;
    state.counters["failed"] = failed;
  }
};

void Ours(benchmark::State& state) {
  for (auto _ : state) {
    Tally tally;
    for (uint64_t i = 0; i < kMeshes; ++i) {
      const DamagedMesh damaged = MakeDamagedMesh(i);
      const ImportResult result = ImportMesh({damaged.mesh, {}, {}}, {1, kDamageWeld}, "part");
      tally.Add(result.report.rims == 0, Volume(result.mesh.triangles()), damaged.volume);
    }
    tally.Tell(state);
  }
}

// Soup repair and orientation, stitching, degenerate faces where asked for, non-manifold vertices, outside
// out.
CgalMesh Repaired(const Triangles& triangles, bool degenerate_faces) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<size_t>> polygons;
  for (const Eigen::Vector3d& p : triangles.vertices) points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& f : triangles.faces)
    polygons.push_back({static_cast<size_t>(f[0]), static_cast<size_t>(f[1]), static_cast<size_t>(f[2])});
  pmp::repair_polygon_soup(points, polygons);
  pmp::orient_polygon_soup(points, polygons);
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  pmp::stitch_borders(mesh);
  if (degenerate_faces) pmp::remove_degenerate_faces(mesh);
  pmp::duplicate_non_manifold_vertices(mesh);
  if (CGAL::is_closed(mesh)) pmp::orient(mesh);
  return mesh;
}

// What is ours before CGAL's functions, which join equal points only and close no T-junctions.
Triangles Prepared(const Triangles& mesh, int64_t level) {
  if (level == 0) return mesh;
  Triangles welded = Weld(mesh, kDamageWeld, nullptr);
  if (level == 2) CloseTJunctions(welded, kDamageWeld);
  return welded;
}

// Arguments: 0 nothing of ours, 1 our weld, 2 our T-junctions too; whether remove_degenerate_faces is called.
void Cgal(benchmark::State& state) {
  const bool degenerate_faces = state.range(1) != 0;
  for (auto _ : state) {
    Tally tally;
    for (uint64_t i = 0; i < kMeshes; ++i) {
      const DamagedMesh damaged = MakeDamagedMesh(i);
      try {
        const CgalMesh mesh = Repaired(Prepared(damaged.mesh, state.range(0)), degenerate_faces);
        const bool closed = CGAL::is_closed(mesh) && !mesh.is_empty();
        tally.Add(closed, closed ? pmp::volume(mesh) : 0, damaged.volume);
      } catch (const std::exception&) {
        ++tally.failed;
      }
    }
    tally.Tell(state);
  }
}

BENCHMARK(Ours)->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK(Cgal)->ArgsProduct({{0, 1, 2}, {0, 1}})->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace millpose
