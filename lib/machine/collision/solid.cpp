// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/solid.hpp"

#include <limits>
#include <numeric>

namespace millpose {
namespace {

struct LessPoint {
  bool operator()(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  }
};

/// Vertices that are equal bit for bit become one: readers of STL may leave three per facet.
std::vector<std::array<int, 3>> Weld(const Triangles& mesh, std::vector<Eigen::Vector3d>& vertices) {
  std::map<Eigen::Vector3d, int, LessPoint> known;
  std::vector<int> renamed;
  renamed.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const auto [entry, fresh] = known.emplace(vertex, static_cast<int>(vertices.size()));
    if (fresh) vertices.push_back(vertex);
    renamed.push_back(entry->second);
  }
  std::vector<std::array<int, 3>> faces;
  for (const auto& face : mesh.faces) {
    const std::array<int, 3> f{renamed[face[0]], renamed[face[1]], renamed[face[2]]};
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) faces.push_back(f);
  }
  return faces;
}

bool RayMeetsBox(const Eigen::Vector3d& p, const Eigen::Vector3d& inverse, const Eigen::Vector3d& lower,
                 const Eigen::Vector3d& upper) {
  const Eigen::Array3d t0 = (lower - p).array() * inverse.array();
  const Eigen::Array3d t1 = (upper - p).array() * inverse.array();
  return t0.max(t1).minCoeff() >= std::max(0.0, t0.min(t1).maxCoeff());
}

}  // namespace

Solid::Solid(const Triangles& mesh) : tree_(mesh.vertices, mesh.faces) {
  std::vector<Eigen::Vector3d> vertices;
  const std::vector<std::array<int, 3>> faces = Weld(mesh, vertices);
  FindTopology(faces, vertices);
}

void Solid::FindTopology(const std::vector<std::array<int, 3>>& faces,
                         const std::vector<Eigen::Vector3d>& vertices) {
  const size_t vertex_count = vertices.size();
  std::vector<int> parent(vertex_count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * faces.size());
  for (const auto& face : faces) {
    for (int i = 0; i < 3; ++i) {
      const int a = face[i], b = face[(i + 1) % 3];
      edges.emplace_back(std::min(a, b), std::max(a, b));
      parent[std::max(root(a), root(b))] = std::min(root(a), root(b));
    }
  }
  std::vector<bool> used(vertex_count, false), named(vertex_count, false);
  for (const auto& [a, b] : edges) used[a] = used[b] = true;
  for (size_t v = 0; v < vertex_count; ++v) {
    if (!used[v] || named[root(static_cast<int>(v))]) continue;
    named[root(static_cast<int>(v))] = true;
    representatives_.push_back(vertices[v]);
  }
  std::sort(edges.begin(), edges.end());
  closed_ = !edges.empty();
  for (size_t i = 0; i < edges.size() && closed_;) {
    size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    closed_ = (end - i) % 2 == 0;
    i = end;
  }
}

Solid::Crossings Solid::Count(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const {
  constexpr double kEdge = 1e-10;  // relative: barycentric coordinates nearer to 0 than this are in doubt
  Crossings crossings;
  const Eigen::Vector3d inverse = direction.cwiseInverse();
  std::vector<int> stack{0};
  while (!stack.empty()) {
    const int index = stack.back();
    const TriangleTree::Node& node = tree_.nodes()[index];
    stack.pop_back();
    if (!RayMeetsBox(p, inverse, node.lower, node.upper)) continue;
    if (node.count == 0) {
      stack.push_back(index + 1);
      stack.push_back(node.right);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const TriangleTree::Corners& corners = tree_.triangles()[i];
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      const Eigen::Vector3d a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
      // Signed volumes of the ray with the edges: all of one sign where it meets the triangle.
      const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)),
                   w = direction.dot(a.cross(b));
      const double scale = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
      const double least = std::min({u, v, w}), most = std::max({u, v, w});
      if (least < -kEdge * scale && most > kEdge * scale) continue;
      if (std::min({std::abs(u), std::abs(v), std::abs(w)}) <= kEdge * scale) {
        crossings.doubtful = true;
        continue;
      }
      const double distance = a.dot((b - a).cross(c - a)) / (u + v + w);
      if (distance > 0) crossings.winding += u > 0 ? 1 : -1;
    }
  }
  return crossings;
}

bool Solid::Contains(const Eigen::Vector3d& p) const {
  if (!closed_) return false;
  const TriangleTree::Node& root = tree_.nodes()[0];
  if ((p.array() < root.lower.array()).any() || (p.array() > root.upper.array()).any()) return false;
  // Directions without a pattern; another one is taken where a ray grazes an edge.
  static const std::array<Eigen::Vector3d, 4> kDirections{
      Eigen::Vector3d(0.8017, 0.2673, 0.5345), Eigen::Vector3d(-0.3371, 0.9013, 0.2719),
      Eigen::Vector3d(0.1931, -0.4327, 0.8806), Eigen::Vector3d(-0.6143, -0.5577, -0.5581)};
  Crossings crossings;
  for (const Eigen::Vector3d& direction : kDirections) {
    crossings = Count(p, direction);
    if (!crossings.doubtful) break;
  }
  return crossings.winding != 0;
}

}  // namespace millpose
