// SPDX-License-Identifier: GPL-3.0-or-later
// Distances the slow way, sharing nothing with lib/machine/collision: every shape as a triangle mesh, every
// triangle against every other, and a winding number by solid angles for inside.
#pragma once

#include <limits>

#include "base/units.hpp"
#include "machine/collision/cell.hpp"

namespace millpose::test {

/// Bodies of revolution from rings (z, radius), `sides` corners inscribed in the circles.
inline Triangles Revolve(const std::vector<std::pair<double, double>>& rings, int sides) {
  Triangles mesh;
  for (const auto& [z, radius] : rings) {
    for (int i = 0; i < sides; ++i) {
      const double a = 2 * kPi * i / sides;
      mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
    }
  }
  const int count = static_cast<int>(rings.size());
  const auto at = [&](int ring, int i) { return ring * sides + i % sides; };
  for (int r = 0; r + 1 < count; ++r) {
    for (int i = 0; i < sides; ++i) {
      mesh.faces.push_back({at(r, i), at(r, i + 1), at(r + 1, i + 1)});
      mesh.faces.push_back({at(r, i), at(r + 1, i + 1), at(r + 1, i)});
    }
  }
  for (int i = 1; i + 1 < sides; ++i) {
    mesh.faces.push_back({at(0, 0), at(0, i + 1), at(0, i)});
    mesh.faces.push_back({at(count - 1, 0), at(count - 1, i), at(count - 1, i + 1)});
  }
  return mesh;
}

/// A capsule (or sphere, length 0) as a mesh.
inline Triangles CapsuleMesh(double radius, double length, int sides) {
  std::vector<std::pair<double, double>> rings;
  const int steps = sides / 2;
  for (int i = 0; i <= steps; ++i) {
    const double latitude = -kPi / 2 + kPi * i / steps;
    const double r = std::max(radius * std::cos(latitude), 1e-9);
    if (2 * i == steps && length > 0) rings.emplace_back(-length / 2, radius);
    rings.emplace_back((2 * i < steps ? -length / 2 : length / 2) + radius * std::sin(latitude), r);
  }
  return Revolve(rings, sides);
}

inline double PointTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  if (n.squaredNorm() > 0 && n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
      n.dot((a - c).cross(p - c)) >= 0) {
    return std::abs(n.dot(p - a)) / n.norm();
  }
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [s, e] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Eigen::Vector3d d = e - s;
    const double t = d.squaredNorm() > 0 ? std::clamp((p - s).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    best = std::min(best, (p - s - t * d).norm());
  }
  return best;
}

inline double SegmentSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& u, const Eigen::Vector3d& q,
                             const Eigen::Vector3d& v) {
  // Inside both segments, or at an end, which the point-triangle distances cover.
  const Eigen::Vector3d w = p - q;
  const double a = u.dot(u), b = u.dot(v), c = v.dot(v), d = u.dot(w), e = v.dot(w), det = a * c - b * b;
  if (det <= 1e-14 * a * c) return std::numeric_limits<double>::infinity();
  const double s = (b * e - c * d) / det, t = (a * e - b * d) / det;
  if (s < 0 || s > 1 || t < 0 || t > 1) return std::numeric_limits<double>::infinity();
  return (w + s * u - t * v).norm();
}

inline bool SegmentMeetsTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double hp = n.dot(p - a), hq = n.dot(q - a);
  if (hp * hq > 0 || hp == hq) return false;
  const Eigen::Vector3d x = p + (q - p) * (hp / (hp - hq));
  return n.dot((b - a).cross(x - a)) >= 0 && n.dot((c - b).cross(x - b)) >= 0 &&
         n.dot((a - c).cross(x - c)) >= 0;
}

inline double TriangleTriangle(const std::array<Eigen::Vector3d, 3>& a,
                               const std::array<Eigen::Vector3d, 3>& b) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (SegmentMeetsTriangle(a[i], a[(i + 1) % 3], b[0], b[1], b[2])) return 0;
    if (SegmentMeetsTriangle(b[i], b[(i + 1) % 3], a[0], a[1], a[2])) return 0;
    best = std::min({best, PointTriangle(a[i], b[0], b[1], b[2]), PointTriangle(b[i], a[0], a[1], a[2])});
    for (int j = 0; j < 3; ++j) {
      best = std::min(best, SegmentSegment(a[i], a[(i + 1) % 3] - a[i], b[j], b[(j + 1) % 3] - b[j]));
    }
  }
  return best;
}

/// Winding number of a closed mesh about p by the triangles' solid angles (van Oosterom and Strackee 1983).
inline double Winding(const Triangles& mesh, const Eigen::Vector3d& p) {
  double sum = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.vertices[f[0]] - p, b = mesh.vertices[f[1]] - p,
                          c = mesh.vertices[f[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * kPi);
}

inline Triangles Moved(Triangles mesh, const Pose& X) {
  for (Eigen::Vector3d& v : mesh.vertices) v = X * v;
  return mesh;
}

/// A triangle's corners and a ball that holds it.
struct BalledTriangle {
  std::array<Eigen::Vector3d, 3> corners;
  Eigen::Vector3d centre;
  double radius;
};

inline std::vector<BalledTriangle> Balled(const Triangles& mesh) {
  std::vector<BalledTriangle> triangles;
  for (const auto& f : mesh.faces) {
    BalledTriangle one{{mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]}, {}, 0};
    one.centre = (one.corners[0] + one.corners[1] + one.corners[2]) / 3;
    for (const auto& corner : one.corners) one.radius = std::max(one.radius, (corner - one.centre).norm());
    triangles.push_back(one);
  }
  return triangles;
}

/// Distance of two closed meshes in one frame, 0 when they touch or one lies in the other.
inline double BruteDistance(const Triangles& a, const Triangles& b) {
  double best = std::numeric_limits<double>::infinity();
  const std::vector<BalledTriangle> first = Balled(a), second = Balled(b);
  for (const BalledTriangle& f : first) {
    for (const BalledTriangle& g : second) {
      if ((f.centre - g.centre).norm() > best + f.radius + g.radius) continue;
      best = std::min(best, TriangleTriangle(f.corners, g.corners));
      if (best == 0) return 0;
    }
  }
  if (std::abs(Winding(a, b.vertices[0])) > 0.5 || std::abs(Winding(b, a.vertices[0])) > 0.5) return 0;
  return best;
}

}  // namespace millpose::test
