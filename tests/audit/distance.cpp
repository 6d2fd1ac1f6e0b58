// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/distance.hpp"

#include <cassert>
#include <cmath>
#include <limits>

namespace millpose::audit {
namespace {

Real DistanceToSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const Real length = d.squaredNorm();
  const Real t = length > 0 ? std::clamp(d.dot(p - a) / length, Real{0}, Real{1}) : Real{0};
  return (p - a - t * d).norm();
}

}  // namespace

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
    const Vector3 d = Vector3(std::cos(turn), 0.377L, std::sin(turn * 1.3L)).normalized();
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
