// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/mesh.hpp"

#include "base/random.hpp"
#include "geometry/mesh/edges.hpp"
#include "geometry/mesh/triangle.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

Eigen::Vector3d RandomPoint(RandomStream& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

TEST(Mesh, ClosestPointAgreesWithTryingEveryFace) {
  const Mesh mesh = SoundMesh(SphereShape(10, 12));
  RandomStream random(3, 0);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p = RandomPoint(random, 20);
    double best = 1e300;
    for (int f = 0; f < mesh.face_count(); ++f) best = std::min(best, mesh.ClosestOnFace(p, f).distance);
    const SurfacePoint closest = mesh.Closest(p);
    EXPECT_EQ(closest.distance, best);
    EXPECT_NEAR((closest.position - p).norm(), best, 1e-12);
    EXPECT_NEAR(closest.barycentric.sum(), 1, 1e-12);
    EXPECT_EQ(mesh.Closest(p, 0.999 * best).face, -1);
    EXPECT_EQ(mesh.Closest(p, 1.001 * best).face, closest.face);
  }
}

TEST(Mesh, ClosestPointOfATriangleAgreesWithDenseSampling) {
  RandomStream random(4, 0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a = RandomPoint(random, 1), b = RandomPoint(random, 1), c = RandomPoint(random, 1),
                          p = RandomPoint(random, 2);
    const Eigen::Vector3d w = ClosestOnTriangle(p, a, b, c);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    double sampled = 1e300;
    for (int u = 0; u <= 60; ++u)
      for (int v = 0; u + v <= 60; ++v)
        sampled = std::min(sampled, (a + u / 60.0 * (b - a) + v / 60.0 * (c - a) - p).norm());
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - 0.06);
  }
}

TEST(Mesh, ContainsAgreesWithTheFormula) {
  const Mesh mesh = SoundMesh(BoxShape({-1, -2, -3}, {1, 2, 3}));
  RandomStream random(5, 0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p = RandomPoint(random, 4);
    const bool inside = std::abs(p.x()) < 1 && std::abs(p.y()) < 2 && std::abs(p.z()) < 3;
    EXPECT_EQ(mesh.Contains(p), inside) << p.transpose();
  }
}

TEST(Mesh, FacesNearAreThoseWithinTheDistance) {
  const Mesh mesh = SoundMesh(SphereShape(10, 10));
  RandomStream random(6, 0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = RandomPoint(random, 12);
    std::vector<int> expected;
    for (int f = 0; f < mesh.face_count(); ++f)
      if (mesh.ClosestOnFace(p, f).distance <= 3) expected.push_back(f);
    EXPECT_EQ(mesh.FacesNear(p, 3), expected);
  }
}

TEST(Mesh, RefusesWhatIsNoManifold) {
  Triangles mesh = BoxShape({0, 0, 0}, {1, 1, 1});
  Flip(mesh, 0);
  EXPECT_THROW(Mesh{mesh}, std::logic_error);
}

// Faces as they come, with corners that fall together and vertices that no face has.
TEST(SortedSides, StandByEdgeThenByNumber) {
  RandomStream random(5, 0);
  for (const int vertices : {1, 2, 7, 400}) {
    Triangles mesh;
    mesh.vertices.resize(static_cast<size_t>(vertices), Eigen::Vector3d::Zero());
    for (int f = 0; f < 500; ++f)
      mesh.faces.push_back({random.Below(vertices), random.Below(vertices), random.Below(vertices)});
    std::vector<std::tuple<int, int, Side>> expected, sorted;
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
        expected.emplace_back(std::min(a, b), std::max(a, b), static_cast<Side>(3 * f + k));
      }
    std::ranges::sort(expected);
    for (const EdgeSide& side : SortedSides(mesh)) sorted.emplace_back(side.low, side.high, side.side);
    EXPECT_EQ(sorted, expected) << vertices;
  }
  EXPECT_TRUE(SortedSides({}).empty());
}

}  // namespace
}  // namespace millpose
