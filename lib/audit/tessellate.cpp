// SPDX-License-Identifier: GPL-3.0-or-later
#include "audit/tessellate.hpp"

#include <algorithm>

#include "base/trig.hpp"

namespace millpose::audit {
namespace {

constexpr int kSides = 96;
constexpr int kLatitudes = 24;  // of a half sphere

/// A ring of corners about z, closed.
std::vector<Vector3> Ring(Real radius, Real z) {
  std::vector<Vector3> ring;
  for (int i = 0; i <= kSides; ++i) {
    const SineCosine turn = SinCos(static_cast<double>(360 * kDegree * (i % kSides) / kSides));
    ring.push_back({radius * turn.cos, radius * turn.sin, z});
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

/// Corners of a convex face in order around its normal; corners inside the rim's edges do no harm.
std::vector<Vector3> Around(std::vector<Vector3> face, const Vector3& normal) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& p : face) centre += p / static_cast<Real>(face.size());
  const Vector3 u = (face[0] - centre).normalized(), v = normal.cross(u);
  std::sort(face.begin(), face.end(), [&](const Vector3& a, const Vector3& b) {
    const auto angle = [&](const Vector3& p) {
      return Atan2(static_cast<double>(v.dot(p - centre)), static_cast<double>(u.dot(p - centre)));
    };
    return angle(a) < angle(b);
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
      const SineCosine latitude =
          SinCos(static_cast<double>(90 * kDegree * (side < 0 ? step - kLatitudes : step) / kLatitudes));
      outline.push_back({radius * latitude.cos, side * length / 2 + radius * latitude.sin});
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
          for (size_t m = 0; m < points.size() && outermost; ++m) {
            const Real height = normal.dot(points[m] - points[i]);
            outermost = height < 1e-7L;
            if (std::abs(height) < 1e-7L) face.push_back(points[m]);
          }
          for (const Vector3& other : seen) known = known || (other - normal).norm() < 1e-7L;
          if (!outermost || known) continue;
          seen.push_back(normal);
          const std::vector<Vector3> rim = Around(face, normal);
          for (size_t c = 1; c + 1 < rim.size(); ++c) mesh.push_back({rim[0], rim[c], rim[c + 1]});
        }
  return mesh;
}

}  // namespace millpose::audit
