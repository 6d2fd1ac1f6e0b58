// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/cutter.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

constexpr int kSides = 48;  // of the polygons around circles: 1/cos(π/48) is 0.2 % more
const double kApothem = SinCos(kPi / kSides).cos;  // of such a polygon with corners at distance 1

/// A circle about z, or a point of it (radius 0); a body of revolution is the hull of several.
struct Ring {
  double z, radius;
};

void AddRing(const Ring& ring, std::vector<Eigen::Vector3d>& points) {
  if (ring.radius <= 0) {
    points.emplace_back(0, 0, ring.z);
    return;
  }
  const double circumscribed = ring.radius / kApothem;
  for (int i = 0; i < kSides; ++i) {
    const SineCosine turn = SinCos(2 * kPi * i / kSides);
    points.emplace_back(circumscribed * turn.cos, circumscribed * turn.sin, ring.z);
  }
}

/// Outline of a capsule from bottom to top: corners of the polygon of kSides sides around its circles.
std::vector<Ring> CapsuleOutline(double radius, double length) {
  const double corner = radius / kApothem;
  std::vector<Ring> rings;
  for (int i = -kSides / 4; i < kSides / 4; ++i) {
    const SineCosine latitude = SinCos((i + 0.5) * 2 * kPi / kSides);
    const double half = i < 0 ? -length / 2 : length / 2;
    rings.push_back({half + corner * latitude.sin, corner * latitude.cos});
  }
  return rings;
}

/// Outline of a body of revolution from bottom to top; empty for other shapes.
std::vector<Ring> Outline(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return CapsuleOutline(s->radius, 0);
  if (const auto* c = std::get_if<Capsule>(&shape)) return CapsuleOutline(c->radius, c->length);
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return {{-c->length / 2, c->radius}, {c->length / 2, c->radius}};
  }
  if (const auto* c = std::get_if<Cone>(&shape)) {
    return {{-c->length / 2, c->radius_bottom}, {c->length / 2, c->radius_top}};
  }
  return {};
}

/// Corners of a polyhedron around the shape, and the segments whose crossings with a plane span the section.
struct Wireframe {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::pair<int, int>> segments;
};

Wireframe WireframeOf(const Shape& shape) {
  Wireframe frame;
  if (const auto* mesh = std::get_if<Triangles>(&shape)) {
    frame.points = mesh->vertices;
    for (const auto& f : mesh->faces) {
      for (int i = 0; i < 3; ++i) frame.segments.emplace_back(f[i], f[(i + 1) % 3]);
    }
    return frame;
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
      frame.points.push_back(corner.cwiseProduct(box->size));
    }
  } else if (const auto* convex = std::get_if<Convex>(&shape)) {
    frame.points = convex->points;
  } else {
    for (const Ring& ring : Outline(shape)) AddRing(ring, frame.points);
  }
  const int count = static_cast<int>(frame.points.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) frame.segments.emplace_back(i, j);
  }
  return frame;
}

/// Part of an outline that stands upright in T above height `z` of the shape's own frame.
std::vector<Eigen::Vector3d> UprightAbove(const std::vector<Ring>& outline, double z) {
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < outline.size(); ++i) {
    if (outline[i].z <= z) continue;
    if (i > 0 && outline[i - 1].z < z) {
      const Ring &a = outline[i - 1], &b = outline[i];
      AddRing({z, a.radius + (b.radius - a.radius) * (z - a.z) / (b.z - a.z)}, points);
    }
    AddRing(outline[i], points);
  }
  return points;
}

}  // namespace

Convex AroundFrustum(const Cone& cone) {
  Convex convex;
  for (const Ring& ring : Outline(cone)) AddRing(ring, convex.points);
  return convex;
}

std::optional<Convex> AboveHeight(const Shape& shape, const Pose& X_TG, double z) {
  Convex part;
  const std::vector<Ring> outline = Outline(shape);
  if (!outline.empty() && X_TG.linear().col(2).isApprox(Eigen::Vector3d::UnitZ(), 1e-12)) {
    part.points = UprightAbove(outline, z - X_TG.translation().z());
    for (Eigen::Vector3d& p : part.points) p = X_TG * p;
  } else {
    Wireframe frame = WireframeOf(shape);
    for (Eigen::Vector3d& p : frame.points) p = X_TG * p;
    for (const Eigen::Vector3d& p : frame.points) {
      if (p.z() > z) part.points.push_back(p);
    }
    for (const auto& [i, j] : frame.segments) {
      const Eigen::Vector3d &a = frame.points[i], &b = frame.points[j];
      if ((a.z() > z) != (b.z() > z)) part.points.push_back(a + (b - a) * ((z - a.z()) / (b.z() - a.z())));
    }
  }
  if (part.points.empty()) return std::nullopt;
  return part;
}

}  // namespace millpose
