// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/view_mesh.hpp"

#include <numbers>
#include <set>

#include "base/trig.hpp"

namespace millpose {
namespace {

constexpr int kSegments = 24;

/// A body of revolution about z through (radius, z) rows, from bottom to top; a row of radius 0 is one
/// vertex.
Triangles Revolved(const std::vector<Eigen::Vector2d>& rows) {
  Triangles mesh;
  std::vector<int> first;
  for (const Eigen::Vector2d& row : rows) {
    first.push_back(static_cast<int>(mesh.vertices.size()));
    for (int s = 0; s < (row.x() > 0 ? kSegments : 1); ++s) {
      const SineCosine turn = SinCos(2 * std::numbers::pi * s / kSegments);
      mesh.vertices.emplace_back(row.x() * turn.cos, row.x() * turn.sin, row.y());
    }
  }
  const auto vertex = [&](size_t r, int s) { return first[r] + (rows[r].x() > 0 ? s % kSegments : 0); };
  for (size_t r = 0; r + 1 < rows.size(); ++r) {
    for (int s = 0; s < kSegments; ++s) {
      if (rows[r].x() > 0) mesh.faces.push_back({vertex(r, s), vertex(r, s + 1), vertex(r + 1, s + 1)});
      if (rows[r + 1].x() > 0) mesh.faces.push_back({vertex(r, s), vertex(r + 1, s + 1), vertex(r + 1, s)});
    }
  }
  return mesh;
}

/// Quarter circles of a ball: rows of the upper (sign 1) or lower half about height z.
std::vector<Eigen::Vector2d> Dome(double radius, double z, int sign) {
  std::vector<Eigen::Vector2d> rows;
  for (int i = 0; i <= kSegments / 4; ++i) {
    const SineCosine turn = SinCos(2 * std::numbers::pi * i / kSegments);
    const bool pole = i == kSegments / 4;
    rows.emplace_back(pole ? 0 : radius * turn.cos, z + sign * radius * turn.sin);
  }
  if (sign < 0) std::reverse(rows.begin(), rows.end());
  return rows;
}

Triangles CapsuleMesh(double radius, double length) {
  std::vector<Eigen::Vector2d> rows = Dome(radius, -0.5 * length, -1);
  const std::vector<Eigen::Vector2d> upper = Dome(radius, 0.5 * length, 1);
  rows.insert(rows.end(), upper.begin(), upper.end());
  return Revolved(rows);
}

Triangles FrustumMesh(double bottom, double top, double length) {
  const double z = 0.5 * length;
  return Revolved({{0, -z}, {bottom, -z}, {top, z}, {0, z}});
}

Triangles BoxMesh(const Eigen::Vector3d& size) {
  Triangles mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(size.x() * (i & 1 ? 0.5 : -0.5), size.y() * (i & 2 ? 0.5 : -0.5),
                               size.z() * (i & 4 ? 0.5 : -0.5));
  for (const auto& [a, b, c, d] : std::array<std::array<int, 4>, 6>{
           {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}}) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  }
  return mesh;
}

struct MeshOf {
  Triangles operator()(const Box& box) const { return BoxMesh(box.size); }
  Triangles operator()(const Sphere& s) const { return CapsuleMesh(s.radius, 0); }
  Triangles operator()(const Cylinder& c) const { return FrustumMesh(c.radius, c.radius, c.length); }
  Triangles operator()(const Capsule& c) const { return CapsuleMesh(c.radius, c.length); }
  Triangles operator()(const Cone& c) const { return FrustumMesh(c.radius_bottom, c.radius_top, c.length); }
  Triangles operator()(const Convex& c) const { return ConvexHull(c.points); }
  Triangles operator()(const Triangles& mesh) const { return mesh; }
};

using Points = std::vector<Eigen::Vector3d>;
using HullFace = std::array<int, 3>;

/// Twice the signed area of a face times the height of `p` above it, mm³.
double Above(const Points& points, const HullFace& f, const Eigen::Vector3d& p) {
  const Eigen::Vector3d& a = points[f[0]];
  return (points[f[1]] - a).cross(points[f[2]] - a).dot(p - a);
}

/// Four points that span a volume, the fourth below the face of the first three; empty when none do.
std::optional<std::array<int, 4>> FirstTetrahedron(const Points& points, double tolerance) {
  const auto farthest = [&](const auto& measure) {
    int best = 0;
    for (int i = 1; i < static_cast<int>(points.size()); ++i)
      if (measure(points[i]) > measure(points[best])) best = i;
    return best;
  };
  const int a = 0;
  const int b = farthest([&](const Eigen::Vector3d& p) { return (p - points[a]).norm(); });
  const Eigen::Vector3d line = (points[b] - points[a]).normalized();
  const int c = farthest([&](const Eigen::Vector3d& p) { return line.cross(p - points[a]).norm(); });
  const HullFace face{a, b, c};
  const int d = farthest([&](const Eigen::Vector3d& p) { return std::abs(Above(points, face, p)); });
  const double volume = Above(points, face, points[d]);
  if (!(std::abs(volume) > tolerance)) return std::nullopt;
  if (volume > 0) return std::array<int, 4>{a, c, b, d};
  return std::array<int, 4>{a, b, c, d};
}

/// One step of the incremental hull: faces that see `index` go, their rim is joined to it.
void AddToHull(const Points& points, int index, double tolerance, std::vector<HullFace>& faces) {
  std::vector<HullFace> kept;
  std::set<std::pair<int, int>> rim;
  for (const HullFace& f : faces) {
    if (Above(points, f, points[index]) <= tolerance) {
      kept.push_back(f);
      continue;
    }
    for (int e = 0; e < 3; ++e) {
      const int from = f[e], to = f[(e + 1) % 3];
      if (rim.erase({to, from}) == 0) rim.insert({from, to});
    }
  }
  for (const auto& [from, to] : rim) kept.push_back({from, to, index});
  faces = std::move(kept);
}

using CellKey = std::array<long long, 3>;

/// The mesh with its vertices gathered in cubes of edge `cell` from `origin`.
Triangles Clustered(const Triangles& mesh, const Eigen::Vector3d& origin, double cell) {
  std::map<CellKey, int> ids;
  std::vector<int> id_of(mesh.vertices.size());
  std::vector<int> counts;
  Triangles result;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d at = (mesh.vertices[v] - origin) / cell;
    const CellKey key{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
    const auto [it, fresh] = ids.emplace(key, static_cast<int>(counts.size()));
    if (fresh) {
      counts.push_back(0);
      result.vertices.push_back(Eigen::Vector3d::Zero());
    }
    id_of[v] = it->second;
    ++counts[it->second];
    result.vertices[it->second] += mesh.vertices[v];
  }
  for (size_t i = 0; i < counts.size(); ++i) result.vertices[i] /= counts[i];
  for (const HullFace& f : mesh.faces) {
    const HullFace g{id_of[f[0]], id_of[f[1]], id_of[f[2]]};
    if (g[0] != g[1] && g[1] != g[2] && g[2] != g[0]) result.faces.push_back(g);
  }
  return result;
}

}  // namespace

Triangles ViewMesh(const Shape& shape) { return std::visit(MeshOf{}, shape); }

Triangles ConvexHull(const Points& points) {
  Triangles hull;
  if (points.size() < 4) return hull;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const double size = box.diagonal().norm(), tolerance = 1e-9 * size * size * size;
  const auto first = FirstTetrahedron(points, tolerance);
  if (!first) return hull;
  const auto [a, b, c, d] = *first;
  std::vector<HullFace> faces{{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}};
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    if (i != a && i != b && i != c && i != d) AddToHull(points, i, tolerance, faces);
  hull.vertices = points;
  hull.faces = std::move(faces);
  return hull;
}

Triangles ThinnedMesh(const Triangles& mesh, size_t max_faces) {
  if (mesh.faces.size() <= max_faces) return mesh;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.vertices) box.extend(p);
  // About two faces a cell on a surface; then finer or coarser by a tenth until the number fits.
  double cell = box.diagonal().norm() / std::sqrt(0.5 * static_cast<double>(max_faces) + 1);
  Triangles thinned = Clustered(mesh, box.min(), cell);
  for (int i = 0; i < 40 && thinned.faces.size() <= max_faces; ++i) {
    Triangles finer = Clustered(mesh, box.min(), cell *= 0.85);
    if (finer.faces.size() > max_faces) return thinned;
    thinned = std::move(finer);
  }
  while (thinned.faces.size() > max_faces) thinned = Clustered(mesh, box.min(), cell *= 1.15);
  return thinned;
}

}  // namespace millpose
