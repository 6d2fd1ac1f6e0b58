// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/t_junctions.hpp"

#include <map>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/edges.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

struct Edge {
  int low, high;
  std::vector<Side> sides;
};

// The edges between vertices of open edges. An edge is open that has one triangle, or another odd number of
// them: something is missing there.
std::vector<Edge> EdgesAtRims(const Triangles& mesh) {
  const std::vector<EdgeSide> sides = SortedSides(mesh);
  std::vector<char> at_rim(mesh.vertices.size(), 0);
  ForEachEdge(sides, [&](size_t begin, size_t end) {
    if ((end - begin) % 2 == 1) at_rim[sides[begin].low] = at_rim[sides[begin].high] = 1;
  });
  std::vector<Edge> edges;
  ForEachEdge(sides, [&](size_t begin, size_t end) {
    if (at_rim[sides[begin].low] == 0 || at_rim[sides[begin].high] == 0) return;
    Edge& edge = edges.emplace_back(Edge{sides[begin].low, sides[begin].high, {}});
    for (size_t i = begin; i < end; ++i) edge.sides.push_back(sides[i].side);
  });
  return edges;
}

// A vertex on an edge, and how far along from its lower vertex (0 to 1).
struct Junction {
  double share;
  int vertex;
};

// The junctions of each edge, in order.
std::vector<std::vector<Junction>> JunctionsOn(const std::vector<Edge>& edges,
                                               const std::vector<Eigen::Vector3d>& at, double tolerance) {
  std::vector<Eigen::AlignedBox3d> boxes;
  std::vector<int> vertices;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(tolerance);
  for (const Edge& edge : edges) {
    boxes.emplace_back(at[edge.low].cwiseMin(at[edge.high]) - reach,
                       at[edge.low].cwiseMax(at[edge.high]) + reach);
    vertices.insert(vertices.end(), {edge.low, edge.high});
  }
  const Bvh tree(boxes);
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::vector<Junction>> junctions(edges.size());
  for (const int vertex : vertices) {
    const Eigen::Vector3d& p = at[vertex];
    tree.ForEachIn(Eigen::AlignedBox3d(p), [&](int i) {
      if (vertex == edges[i].low || vertex == edges[i].high) return;
      const Eigen::Vector3d &a = at[edges[i].low], &b = at[edges[i].high];
      const double share = ClosestOnSegment(p, a, b);
      if (share > 0 && share < 1 && (a + share * (b - a) - p).norm() <= tolerance)
        junctions[i].push_back({share, vertex});
    });
  }
  for (std::vector<Junction>& on_edge : junctions)
    std::ranges::sort(on_edge, {}, [](const Junction& j) { return std::pair(j.share, j.vertex); });
  return junctions;
}

class Splitter {
 public:
  explicit Splitter(Triangles& mesh) : mesh_(mesh) {}

  // Splits a triangle at the vertices of its sides, each side's in its direction. How often.
  size_t Split(int face, const std::array<std::vector<int>, 3>& vertices) {
    const std::array<int, 3> corners = mesh_.faces[face];
    std::array<Side, 3> at{3 * face, 3 * face + 1, 3 * face + 2};  // what is left of each side
    size_t count = 0;
    for (int k = 0; k < 3; ++k)
      for (const int vertex : vertices[k]) {
        if (std::ranges::find(corners, vertex) != corners.end()) continue;  // a flat triangle's own
        const Side far = SplitSide(at[k], vertex);
        for (Side& other : at)
          if (other == NextSide(at[k])) other = NextSide(far);
        at[k] = far;
        ++count;
      }
    return count;
  }

 private:
  // (a, b, c) with the side (a, b) becomes (a, vertex, c) and (vertex, b, c). Returns the side (vertex, b).
  Side SplitSide(Side side, int vertex) {
    const int k = CornerOf(side);
    std::array<int, 3> far = mesh_.faces[FaceOf(side)];
    far[k] = vertex;
    mesh_.faces[FaceOf(side)][(k + 1) % 3] = vertex;
    mesh_.faces.push_back(far);
    if (!mesh_.source.empty()) mesh_.source.push_back(mesh_.source[FaceOf(side)]);
    return 3 * static_cast<Side>(mesh_.faces.size() - 1) + k;
  }

  Triangles& mesh_;
};

}  // namespace

size_t CloseTJunctions(Triangles& mesh, double tolerance) {
  const std::vector<Edge> edges = EdgesAtRims(mesh);
  const std::vector<std::vector<Junction>> junctions = JunctionsOn(edges, mesh.vertices, tolerance);
  // At a common edge of two bodies all sides are split at all junctions, or sides of the two would pair.
  std::map<int, std::array<std::vector<int>, 3>> by_face;
  for (size_t i = 0; i < edges.size(); ++i)
    for (const Side side : edges[i].sides) {
      if (junctions[i].empty()) continue;
      std::vector<int>& vertices = by_face[FaceOf(side)][CornerOf(side)];
      for (const Junction& junction : junctions[i]) vertices.push_back(junction.vertex);
      if (mesh.faces[FaceOf(side)][CornerOf(side)] != edges[i].low) std::ranges::reverse(vertices);
    }
  size_t count = 0;
  for (const auto& [face, vertices] : by_face) count += Splitter(mesh).Split(face, vertices);
  return count;
}

}  // namespace millpose
