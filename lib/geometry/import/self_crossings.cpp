// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/self_crossings.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <numeric>

#include "geometry/mesh/mesh_impl.hpp"

namespace millpose {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point At(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

// A triangle whose corners are told by the place of their vertex.
struct Corners {
  std::array<int, 3> id;
  std::array<Point, 3> at;
  Kernel::Triangle_3 triangle() const { return {at[0], at[1], at[2]}; }
};

// Whether the side of `a` from corner i+1 to i+2 meets `b`.
bool OppositeSideMeets(const Corners& a, int i, const Corners& b) {
  const Point &p = a.at[(i + 1) % 3], &q = a.at[(i + 2) % 3];
  const auto low = CGAL::orientation(b.at[0], b.at[1], b.at[2], p);
  const auto high = CGAL::orientation(b.at[0], b.at[1], b.at[2], q);
  if (low == high && low != CGAL::COPLANAR) return false;
  return CGAL::do_intersect(Kernel::Segment_3(p, q), b.triangle());
}

bool Meet(const Corners& a, const Corners& b) {
  int shared = 0, in_a = 0, in_b = 0, sum_a = 0, sum_b = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a.id[i] == b.id[j]) {
        ++shared;
        in_a = i, in_b = j;
        sum_a += i, sum_b += j;
      }
  if (shared == 0) return CGAL::do_intersect(a.triangle(), b.triangle());
  if (shared == 1) return OppositeSideMeets(a, in_a, b) || OppositeSideMeets(b, in_b, a);
  if (shared == 3) return true;  // the same place twice
  // Over a common edge they meet only when folded onto each other.
  const int apex_a = 3 - sum_a, apex_b = 3 - sum_b;
  const Point &p = a.at[(apex_a + 1) % 3], &q = a.at[(apex_a + 2) % 3];
  return CGAL::orientation(p, q, a.at[apex_a], b.at[apex_b]) == CGAL::COPLANAR &&
         CGAL::coplanar_orientation(p, q, a.at[apex_a], b.at[apex_b]) == CGAL::POSITIVE;
}

// The lowest number of a vertex at the same place, for each vertex.
std::vector<int> Places(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {},
                    [&](int v) { return std::tuple(vertices[v].x(), vertices[v].y(), vertices[v].z(), v); });
  std::vector<int> places(vertices.size());
  for (size_t i = 0; i < order.size(); ++i)
    places[order[i]] =
        i > 0 && vertices[order[i]] == vertices[order[i - 1]] ? places[order[i - 1]] : order[i];
  return places;
}

}  // namespace

SelfCrossings FindSelfCrossings(const Mesh& mesh, const std::vector<int>& body_of_source) {
  const Triangles& triangles = mesh.triangles();
  const auto apart = [&](int a, int b) {
    return !body_of_source.empty() &&
           body_of_source[triangles.source[a]] != body_of_source[triangles.source[b]];
  };
  const std::vector<int> places = Places(triangles.vertices);
  const auto corners = [&](int face) {
    Corners c;
    for (int k = 0; k < 3; ++k) {
      c.id[k] = places[triangles.faces[face][k]];
      c.at[k] = At(mesh.Corner(face, k));
    }
    return c;
  };
  using Boxes = std::vector<Eigen::AlignedBox3d>;
  const auto boxes_of = [&](std::span<const int> leaf, Boxes& boxes) {
    boxes.clear();
    for (const int face : leaf) {
      boxes.emplace_back(mesh.Corner(face, 0));
      boxes.back().extend(mesh.Corner(face, 1)).extend(mesh.Corner(face, 2));
    }
  };
  // A sound mesh has some 7 tests and 100 looks at boxes a triangle.
  const size_t faces = triangles.faces.size();
  size_t tests_left = 60 * faces + 1'000'000, looks_left = 1000 * faces + 10'000'000;
  // Of a mesh with more nobody looks for the last; triangles in one plane, as in a fan on one edge, are told
  // apart by exact numbers alone, at microseconds a pair.
  constexpr size_t kMostPairs = 20'000;
  SelfCrossings found;
  Boxes left_boxes, right_boxes;
  mesh.impl().tree.ForEachLeafPair([&](std::span<const int> left, std::span<const int> right) {
    const bool same = left.data() == right.data();
    boxes_of(left, left_boxes);
    boxes_of(right, right_boxes);
    for (size_t i = 0; i < left.size(); ++i)
      for (size_t k = same ? i + 1 : 0; k < right.size(); ++k) {
        if (looks_left == 0 || tests_left == 0 || found.pairs == kMostPairs) {
          found.complete = false;
          return false;
        }
        --looks_left;
        const int a = left[i], b = right[k];
        if (!left_boxes[i].intersects(right_boxes[k]) || apart(a, b)) continue;
        --tests_left;
        if (!Meet(corners(a), corners(b))) continue;
        const int first = std::min(a, b);
        if (found.pairs++ == 0)
          found.place = (mesh.Corner(first, 0) + mesh.Corner(first, 1) + mesh.Corner(first, 2)) / 3;
      }
    return true;
  });
  return found;
}

}  // namespace millpose
