// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/tessellate.hpp"

#include <cmath>
#include <cstring>
#include <sstream>

namespace millpose::audit {
namespace {

constexpr int kSides = 96;
constexpr int kLatitudes = 24;  // of a half sphere

/// A ring of corners about z, closed.
std::vector<Vector3> Ring(Real radius, Real z) {
  std::vector<Vector3> ring;
  for (int i = 0; i <= kSides; ++i) {
    const Real angle = 360 * kDegree * (i % kSides) / kSides;
    ring.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return ring;
}

/// Body of revolution: rings from bottom to top with a flat lid on both ends.
Mesh Revolve(const std::vector<std::pair<Real, Real>>& radius_and_z) {
  Mesh mesh;
  for (size_t k = 0; k < radius_and_z.size(); ++k) {
    const std::vector<Vector3> ring = Ring(radius_and_z[k].first, radius_and_z[k].second);
    const Vector3 centre(0, 0, radius_and_z[k].second);
    for (size_t i = 0; i < kSides; ++i) {
      if (k == 0) mesh.push_back({centre, ring[i + 1], ring[i]});
      if (k + 1 == radius_and_z.size()) mesh.push_back({centre, ring[i], ring[i + 1]});
      if (k + 1 < radius_and_z.size()) {
        const std::vector<Vector3> next = Ring(radius_and_z[k + 1].first, radius_and_z[k + 1].second);
        mesh.push_back({ring[i], ring[i + 1], next[i + 1]});
        mesh.push_back({ring[i], next[i + 1], next[i]});
      }
    }
  }
  return mesh;
}

Real Number(const std::string& text) { return std::stold(text); }

Mesh ReadAsciiStl(const std::string& bytes, Real unit) {
  std::istringstream words(bytes);
  std::string word;
  std::vector<Vector3> corners;
  while (words >> word) {
    if (word != "vertex" && word != "VERTEX") continue;
    std::string x, y, z;
    words >> x >> y >> z;
    corners.push_back({Number(x) * unit, Number(y) * unit, Number(z) * unit});
  }
  Mesh mesh;
  for (size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

/// Corners of a convex face in order around its normal; corners inside the rim's edges do no harm.
std::vector<Vector3> Around(std::vector<Vector3> face, const Vector3& normal) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& p : face) centre += p / static_cast<Real>(face.size());
  const Vector3 u = (face[0] - centre).normalized(), v = normal.cross(u);
  std::sort(face.begin(), face.end(), [&](const Vector3& a, const Vector3& b) {
    return std::atan2(v.dot(a - centre), u.dot(a - centre)) <
           std::atan2(v.dot(b - centre), u.dot(b - centre));
  });
  return face;
}

}  // namespace

Mesh BoxMesh(const Vector3& size) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto corner = [&](int su, int sv) {
        Vector3 p;
        p[axis] = side * size[axis] / 2;
        p[u] = su * size[u] / 2;
        p[v] = sv * size[v] / 2;
        return p;
      };
      mesh.push_back({corner(-1, -1), corner(side, -side), corner(1, 1)});
      mesh.push_back({corner(-1, -1), corner(1, 1), corner(-side, side)});
    }
  return mesh;
}

Mesh Frustum(Real radius_bottom, Real radius_top, Real length) {
  return Revolve({{radius_bottom, -length / 2}, {radius_top, length / 2}});
}

Mesh CapsuleMesh(Real radius, Real length) {
  std::vector<std::pair<Real, Real>> outline;
  for (int side : {-1, 1})
    for (int i = 0; i < kLatitudes; ++i) {
      if (length == 0 && side > 0 && i == 0) continue;  // a sphere has one equator
      const int step = side < 0 ? i + 1 : i;
      const Real latitude = 90 * kDegree * (side < 0 ? step - kLatitudes : step) / kLatitudes;
      outline.push_back({radius * std::cos(latitude), side * length / 2 + radius * std::sin(latitude)});
    }
  return Revolve(outline);
}

Mesh HullMesh(const std::vector<Vector3>& points) {
  Mesh mesh;
  std::vector<Vector3> seen;  // normals of the faces found so far
  for (size_t i = 0; i < points.size(); ++i)
    for (size_t j = i + 1; j < points.size(); ++j)
      for (size_t k = j + 1; k < points.size(); ++k)
        for (const Real side : {Real{1}, Real{-1}}) {
          Vector3 normal = side * (points[j] - points[i]).cross(points[k] - points[i]);
          if (normal.norm() < 1e-9L) continue;
          normal.normalize();
          std::vector<Vector3> face;
          bool outermost = true, known = false;
          for (const Vector3& p : points) {
            const Real height = normal.dot(p - points[i]);
            outermost = outermost && height < 1e-7L;
            if (std::abs(height) < 1e-7L) face.push_back(p);
          }
          for (const Vector3& other : seen) known = known || (other - normal).norm() < 1e-7L;
          if (!outermost || known) continue;
          seen.push_back(normal);
          const std::vector<Vector3> rim = Around(face, normal);
          for (size_t c = 1; c + 1 < rim.size(); ++c) mesh.push_back({rim[0], rim[c], rim[c + 1]});
        }
  return mesh;
}

Mesh ReadStl(const std::string& bytes, Real unit) {
  uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() != 84 + size_t{50} * count) return ReadAsciiStl(bytes, unit);
  Mesh mesh(count);
  for (size_t i = 0; i < count; ++i)
    for (size_t corner = 0; corner < 3; ++corner) {
      float xyz[3];
      std::memcpy(xyz, bytes.data() + 84 + 50 * i + 12 * (corner + 1), 12);
      mesh[i][corner] = Vector3(xyz[0], xyz[1], xyz[2]) * unit;
    }
  return mesh;
}

}  // namespace millpose::audit
