// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/view_mesh.hpp"

#include "base/random.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

/// The volume that a closed mesh with outward faces encloses, mm³.
double Volume(const Triangles& mesh) {
  double six = 0;
  for (const auto& f : mesh.faces)
    six += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]]));
  return six / 6;
}

double EdgesWithoutPartner(const Triangles& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& f : mesh.faces)
    for (int e = 0; e < 3; ++e) {
      const int a = f[e], b = f[(e + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  int open = 0;
  for (const auto& [edge, sum] : edges) open += sum != 0;
  return open;
}

TEST(ViewMesh, ShapesEncloseNearlyTheirVolume) {
  const struct {
    Shape shape;
    double volume;
  } cases[] = {{Box{{100, 50, 20}}, 1e5},
               {Cylinder{30, 80}, kPi * 900 * 80},
               {Sphere{40}, 4 * kPi / 3 * 64000},
               {Capsule{20, 100}, kPi * 400 * 100 + 4 * kPi / 3 * 8000},
               {Cone{10, 30, 60}, kPi * 60 * (100 + 300 + 900) / 3}};
  for (const auto& c : cases) {
    const Triangles mesh = ViewMesh(c.shape);
    EXPECT_LE(Volume(mesh), c.volume * (1 + 1e-12));
    EXPECT_GT(Volume(mesh), 0.96 * c.volume);
    EXPECT_EQ(EdgesWithoutPartner(mesh), 0);
  }
}

TEST(ViewMesh, HullHoldsItsPointsAndIsClosed) {
  RandomStream random(3, 0);
  for (int round = 0; round < 20; ++round) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 60; ++i)
      points.push_back({100 * random.Normal(), 50 * random.Normal(), 300 * random.Normal()});
    const Triangles hull = ConvexHull(points);
    EXPECT_EQ(EdgesWithoutPartner(hull), 0);
    ASSERT_GE(hull.faces.size(), 4u);
    for (const auto& f : hull.faces) {
      const Eigen::Vector3d a = points[f[0]];
      const Eigen::Vector3d normal = (points[f[1]] - a).cross(points[f[2]] - a).normalized();
      for (const Eigen::Vector3d& p : points) EXPECT_LT(normal.dot(p - a), 1e-3);
    }
  }
}

TEST(ViewMesh, HullOfABoxIsTheBox) {
  const Triangles box = ViewMesh(Box{{10, 20, 30}});
  const Triangles hull = ConvexHull(box.vertices);
  EXPECT_EQ(hull.faces.size(), 12u);
  EXPECT_NEAR(Volume(hull), 6000, 1e-9);
}

TEST(ViewMesh, HullOfAPlaneIsEmpty) {
  EXPECT_TRUE(ConvexHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 3, 0}}).faces.empty());
}

/// A ball as a fine mesh: a capsule of length 0, split `levels` times.
Triangles FineBall(double radius, int levels) {
  Triangles mesh = ViewMesh(Sphere{radius});
  for (int level = 0; level < levels; ++level) {
    Triangles finer{mesh.vertices, {}};
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(finer.vertices.size()));
      if (fresh) finer.vertices.push_back(radius * (mesh.vertices[a] + mesh.vertices[b]).normalized());
      return it->second;
    };
    for (const auto& [a, b, c] : mesh.faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.faces.insert(finer.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh = std::move(finer);
  }
  return mesh;
}

TEST(ViewMesh, ThinnedStaysUnderTheNumberAndNearTheShape) {
  const Triangles ball = FineBall(500, 3);
  ASSERT_GT(ball.faces.size(), 30000u);
  for (size_t most : {5000u, 500u}) {
    const Triangles thinned = ThinnedMesh(ball, most);
    EXPECT_LE(thinned.faces.size(), most);
    EXPECT_GT(thinned.faces.size(), most / 2);
    EXPECT_GT(Volume(thinned), 0.85 * Volume(ball));
    for (const Eigen::Vector3d& p : thinned.vertices) EXPECT_NEAR(p.norm(), 500, 60);
  }
}

TEST(ViewMesh, SmallMeshesAreLeftAlone) {
  const Triangles box = ViewMesh(Box{{10, 20, 30}});
  EXPECT_EQ(ThinnedMesh(box, 12).faces, box.faces);
}

}  // namespace
}  // namespace millpose
