// SPDX-License-Identifier: GPL-3.0-or-later
#include "audit/distance.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "base/trig.hpp"

namespace millpose::audit {
namespace {

Real DistanceToSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const Real length = d.squaredNorm();
  const Real t = length > 0 ? std::clamp(d.dot(p - a) / length, Real{0}, Real{1}) : Real{0};
  return (p - a - t * d).norm();
}

/// Of two segments where both are nearest to each other between their ends; the ends are looked at elsewhere.
Real DistanceBetween(const Vector3& p, const Vector3& u, const Vector3& q, const Vector3& v) {
  const Vector3 n = u.cross(v), w = q - p;
  const Real square = n.squaredNorm();
  if (square <= 1e-24L * u.squaredNorm() * v.squaredNorm()) return std::numeric_limits<Real>::infinity();
  const Real s = w.cross(v).dot(n) / square, t = w.cross(u).dot(n) / square;
  if (s < 0 || s > 1 || t < 0 || t > 1) return std::numeric_limits<Real>::infinity();
  return std::abs(w.dot(n)) / std::sqrt(square);
}

/// Whether the segment from p to q goes through a triangle.
bool Pierces(const Vector3& p, const Vector3& q, const std::array<Vector3, 3>& t) {
  const Vector3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const Real from = normal.dot(p - t[0]), to = normal.dot(q - t[0]);
  if (from == to || (from > 0) == (to > 0)) return false;
  const Vector3 at = p + (q - p) * (from / (from - to));
  for (size_t i = 0; i < 3; ++i)
    if (normal.dot((t[(i + 1) % 3] - t[i]).cross(at - t[i])) < 0) return false;
  return true;
}

struct Extent {
  Vector3 lower, upper;
  explicit Extent(const std::array<Vector3, 3>& t)
      : lower(t[0].cwiseMin(t[1]).cwiseMin(t[2])), upper(t[0].cwiseMax(t[1]).cwiseMax(t[2])) {}
  void Add(const Extent& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
  Real SquaredGap(const Extent& other) const {
    return (lower - other.upper).cwiseMax(other.lower - upper).cwiseMax(Real{0}).squaredNorm();
  }
};

}  // namespace

Real Distance(const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b) {
  Real nearest = std::numeric_limits<Real>::infinity();
  for (size_t i = 0; i < 3; ++i) {
    const Vector3 &a0 = a[i], &a1 = a[(i + 1) % 3];
    if (Pierces(a0, a1, b) || Pierces(b[i], b[(i + 1) % 3], a)) return 0;
    nearest = std::min({nearest, Distance(a0, b), Distance(b[i], a)});
    for (size_t j = 0; j < 3; ++j)
      nearest = std::min(nearest, DistanceBetween(a0, a1 - a0, b[j], b[(j + 1) % 3] - b[j]));
  }
  return nearest;
}

Real Distance(const Mesh& a, const Mesh& b, Real bound) {
  if (a.empty() || b.empty()) return bound;
  Extent whole(b[0]);
  for (const auto& t : b) whole.Add(Extent(t));
  std::vector<std::pair<Extent, const std::array<Vector3, 3>*>> near;
  for (const auto& t : a)
    if (const Extent extent(t); extent.SquaredGap(whole) < bound * bound) near.emplace_back(extent, &t);
  Real nearest = bound;
  for (const auto& t : b) {
    const Extent extent(t);
    for (const auto& [other, triangle] : near)
      if (extent.SquaredGap(other) < nearest * nearest) nearest = std::min(nearest, Distance(*triangle, t));
  }
  return nearest;
}

Real Distance(const Vector3& p, const std::array<Vector3, 3>& t) {
  Real nearest = std::numeric_limits<Real>::infinity();
  for (size_t i = 0; i < 3; ++i) nearest = std::min(nearest, DistanceToSegment(p, t[i], t[(i + 1) % 3]));
  const Vector3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (normal.squaredNorm() == 0) return nearest;
  for (size_t i = 0; i < 3; ++i)
    if (normal.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) < 0) return nearest;
  return std::min(nearest, std::abs(normal.normalized().dot(p - t[0])));
}

Real Distance(const Vector3& p, const Mesh& mesh) {
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const auto& t : mesh) {
    const Vector3 lower = t[0].cwiseMin(t[1]).cwiseMin(t[2]), upper = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    const Vector3 outside = (lower - p).cwiseMax(p - upper).cwiseMax(Real{0});
    if (outside.squaredNorm() < nearest * nearest) nearest = std::min(nearest, Distance(p, t));
  }
  return nearest;
}

bool IsClosed(const Mesh& mesh) {
  using Key = std::array<long long, 3>;
  std::map<std::pair<Key, Key>, int> uses;
  for (const auto& t : mesh)
    for (size_t i = 0; i < 3; ++i) {
      Key ends[2];
      for (size_t end = 0; end < 2; ++end)
        for (int k = 0; k < 3; ++k)
          ends[end][static_cast<size_t>(k)] = std::llround(t[(i + end) % 3][k] * 1e6L);
      ++uses[std::minmax(ends[0], ends[1])];
    }
  for (const auto& [edge, count] : uses)
    if (count != 2) return false;
  return !mesh.empty();
}

bool IsInside(const Vector3& p, const Mesh& mesh) {
  // Möller and Trumbore 1997; directions without any symmetry that a part may have.
  for (Real turn = 0.1L; turn < 10; turn += 0.7L) {
    const Vector3 d =
        Vector3(SinCos(static_cast<double>(turn)).cos, 0.377L, SinCos(static_cast<double>(turn * 1.3L)).sin)
            .normalized();
    bool odd = false, doubtful = false;
    for (const auto& t : mesh) {
      const Vector3 e1 = t[1] - t[0], e2 = t[2] - t[0], h = d.cross(e2);
      const Real a = e1.dot(h);
      if (std::abs(a) < 1e-14L * e1.norm() * e2.norm()) continue;
      const Vector3 s = p - t[0];
      const Real u = s.dot(h) / a, v = d.dot(s.cross(e1)) / a, w = e2.dot(s.cross(e1)) / a;
      if (w < 0 || u < -1e-9L || v < -1e-9L || u + v > 1 + 1e-9L) continue;
      if (u < 1e-9L || v < 1e-9L || u + v > 1 - 1e-9L) doubtful = true;
      odd = !odd;
    }
    if (!doubtful) return odd;
  }
  assert(false && "no ray passes between the edges");
  return false;
}

}  // namespace millpose::audit
