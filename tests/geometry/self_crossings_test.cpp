// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/self_crossings.hpp"

#include "base/random.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;

double Volume(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  return (b - a).cross(c - a).dot(d - a);
}

// For points in general position alone.
bool SegmentMeets(const Vector& p, const Vector& q, const Vector& a, const Vector& b, const Vector& c) {
  if (Volume(a, b, c, p) * Volume(a, b, c, q) > 0) return false;
  const double u = Volume(p, q, a, b), v = Volume(p, q, b, c), w = Volume(p, q, c, a);
  return (u > 0) == (v > 0) && (v > 0) == (w > 0);
}

bool Meet(const Mesh& mesh, int f, int g) {
  for (int k = 0; k < 3; ++k)
    if (SegmentMeets(mesh.Corner(f, k), mesh.Corner(f, (k + 1) % 3), mesh.Corner(g, 0), mesh.Corner(g, 1),
                     mesh.Corner(g, 2)) ||
        SegmentMeets(mesh.Corner(g, k), mesh.Corner(g, (k + 1) % 3), mesh.Corner(f, 0), mesh.Corner(f, 1),
                     mesh.Corner(f, 2)))
      return true;
  return false;
}

TEST(SelfCrossings, AgreeWithAllPairsOnRandomTriangles) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random(seed, 41);
    Triangles soup;
    for (int f = 0; f < 120; ++f) {
      const Vector centre{random.Uniform(0, 10), random.Uniform(0, 10), random.Uniform(0, 10)};
      for (int k = 0; k < 3; ++k)
        soup.vertices.push_back(centre +
                                Vector{random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(-2, 2)});
      soup.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const Mesh mesh(soup);
    size_t expected = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int g = f + 1; g < mesh.face_count(); ++g) expected += Meet(mesh, f, g) ? 1 : 0;
    const SelfCrossings found = FindSelfCrossings(mesh);
    EXPECT_EQ(found.pairs, expected);
    EXPECT_GT(found.pairs, 20u);
    EXPECT_TRUE(found.complete);
  }
}

TEST(SelfCrossings, SoundMeshesHaveNone) {
  for (const Triangles& shape : {BoxShape({0, 0, 0}, {1, 2, 3}), CylinderShape(50, 80, 60, 7),
                                 SphereShape(30, 24), GridShape(20, 20, 1)})
    EXPECT_EQ(FindSelfCrossings(SoundMesh(shape)).pairs, 0u);
}

TEST(SelfCrossings, AVertexPushedThroughTheOtherSideIsFound) {
  Triangles sphere = SphereShape(30, 12);
  size_t top = 0;
  for (size_t v = 0; v < sphere.vertices.size(); ++v)
    if (sphere.vertices[v].z() > sphere.vertices[top].z()) top = v;
  sphere.vertices[top].z() = -35;
  const SelfCrossings found = FindSelfCrossings(SoundMesh(sphere));
  EXPECT_GT(found.pairs, 0u);
  EXPECT_LE(found.place.norm(), 36);
}

TEST(SelfCrossings, GivesUpWhereMostTrianglesMeet) {
  Triangles star;
  RandomStream random(5, 41);
  for (int f = 0; f < 6000; ++f) {
    for (int k = 0; k < 3; ++k)
      star.vertices.push_back({random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
    star.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  const SelfCrossings found = FindSelfCrossings(Mesh(star));
  EXPECT_FALSE(found.complete);
  EXPECT_GT(found.pairs, 1000u);
}

}  // namespace
}  // namespace millpose
