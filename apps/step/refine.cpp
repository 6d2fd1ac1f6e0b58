// SPDX-License-Identifier: GPL-3.0-or-later
#include "refine.hpp"

#include <algorithm>

#include "geometry/mesh/edges.hpp"

namespace millpose {
namespace {

using Surface = std::function<Eigen::Vector3d(const Eigen::Vector2d&)>;

// A side that two triangles share.
struct Inner {
  Side first, second;
  double deviation;
};

// Whether a parameter has no effect at a place (the longitude at a pole).
bool IsSingular(const Eigen::Vector2d& at, int k, const Surface& surface) {
  Eigen::Vector2d beside = at;
  beside[k] += 1e-3;
  return (surface(beside) - surface(at)).norm() < 1e-9;
}

// The parameter between two points; where one has no effect at an end, that of the other end counts.
Eigen::Vector2d Between(const FaceTriangles& cut, int a, int b, const Surface& surface) {
  const Eigen::Vector2d &p = cut.parameters[a], &q = cut.parameters[b];
  Eigen::Vector2d middle = (p + q) / 2;
  for (int k = 0; k < 2; ++k) {
    if (p[k] == q[k]) continue;
    if (IsSingular(p, k, surface)) {
      middle[k] = q[k];
    } else if (IsSingular(q, k, surface)) {
      middle[k] = p[k];
    }
  }
  return middle;
}

// The distance of the surface from the middle of a side, seen across the side. Both ends count as lying on
// the surface: those on the rim lie as near as the file is exact.
double DeviationOf(const FaceTriangles& cut, int a, int b, const Surface& surface) {
  const Eigen::Vector3d p = surface(cut.parameters[a]), q = surface(cut.parameters[b]);
  const Eigen::Vector3d middle = surface(Between(cut, a, b, surface));
  const Eigen::Vector3d along = q - p;
  const double length = along.norm();
  return length > 0 ? along.cross(middle - p).norm() / length : 0;
}

std::vector<Inner> InnerSides(const FaceTriangles& cut, const Surface& surface) {
  const std::vector<EdgeSide> sides = SortedSides({cut.points, cut.faces});
  std::vector<Inner> inner;
  ForEachEdge(sides, [&](size_t begin, size_t end) {
    if (end - begin == 2)
      inner.push_back({sides[begin].side, sides[begin + 1].side,
                       DeviationOf(cut, sides[begin].low, sides[begin].high, surface)});
  });
  return inner;
}

// Makes (a, b, c) with the given side (a, b) into (a, middle, c) and (middle, b, c).
void SplitFace(FaceTriangles& cut, Side side, int middle) {
  const std::array<int, 3> face = cut.faces[FaceOf(side)];
  const int k = CornerOf(side), a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
  cut.faces[FaceOf(side)] = {a, middle, c};
  cut.faces.push_back({middle, b, c});
}

}  // namespace

double Refine(FaceTriangles& cut, double tolerance, const Surface& surface) {
  constexpr int kRounds = 40;
  constexpr size_t kMost = 4'000'000;  // triangles of a face
  double left = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Inner> inner = InnerSides(cut, surface);
    std::ranges::stable_sort(inner, std::greater(), &Inner::deviation);
    left = inner.empty() ? 0 : inner.front().deviation;
    if (left <= tolerance || cut.faces.size() > kMost) break;
    // Worst sides first; each triangle is split once a round.
    std::vector<char> done(cut.faces.size(), 0);
    for (const auto& [first, second, deviation] : inner) {
      if (deviation <= tolerance) break;
      if (done[FaceOf(first)] != 0 || done[FaceOf(second)] != 0) continue;
      done[FaceOf(first)] = done[FaceOf(second)] = 1;
      const auto& face = cut.faces[FaceOf(first)];
      const int a = face[CornerOf(first)], b = face[(CornerOf(first) + 1) % 3];
      const auto middle = static_cast<int>(cut.points.size());
      cut.parameters.push_back(Between(cut, a, b, surface));
      cut.points.push_back(surface(cut.parameters.back()));
      SplitFace(cut, first, middle);
      SplitFace(cut, second, middle);
    }
  }
  return left;
}

}  // namespace millpose
