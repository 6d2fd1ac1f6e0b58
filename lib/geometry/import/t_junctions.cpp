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

// Whether the segment from a to b meets the box; never false where it does.
bool SegmentMeets(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  double from = 0, to = 1;  // the part of the segment that lies between the planes so far
  for (int k = 0; k < 3; ++k) {
    const double along = b[k] - a[k], lower = box.min()[k] - a[k], upper = box.max()[k] - a[k];
    if (along == 0.0) {
      if (lower > 0 || upper < 0) return false;
      continue;
    }
    from = std::max(from, std::min(lower / along, upper / along));
    to = std::min(to, std::max(lower / along, upper / along));
  }
  constexpr double kRounding = 1e-9;  // of the quotients
  return from <= to + kRounding;
}

// The junctions of each edge, in order. Edges look for vertices along themselves: the boxes of long slanting
// edges, as in a fan, would each hold most vertices.
std::vector<std::vector<Junction>> JunctionsOn(const std::vector<Edge>& edges,
                                               const std::vector<Eigen::Vector3d>& at, double tolerance) {
  std::vector<int> vertices;
  for (const Edge& edge : edges) vertices.insert(vertices.end(), {edge.low, edge.high});
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Eigen::AlignedBox3d> boxes;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(tolerance);
  for (const int vertex : vertices) boxes.emplace_back(at[vertex] - reach, at[vertex] + reach);
  const Bvh tree(boxes);
  std::vector<std::vector<Junction>> junctions(edges.size());
  for (size_t i = 0; i < edges.size(); ++i) {
    const Eigen::Vector3d &a = at[edges[i].low], &b = at[edges[i].high];
    tree.ForEachWhere([&](const Eigen::AlignedBox3d& box) { return SegmentMeets(box, a, b); },
                      [&](int k) {
                        const int vertex = vertices[static_cast<size_t>(k)];
                        if (vertex == edges[i].low || vertex == edges[i].high) return;
                        const double share = ClosestOnSegment(at[vertex], a, b);
                        if (share > 0 && share < 1 && (a + share * (b - a) - at[vertex]).norm() <= tolerance)
                          junctions[i].push_back({share, vertex});
                      });
    std::ranges::sort(junctions[i], {}, [](const Junction& j) { return std::pair(j.share, j.vertex); });
  }
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
