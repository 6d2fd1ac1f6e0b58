// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/solid.hpp"

#include "tests/machine/collision/brute_force.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

TEST(Solid, AgreesWithTheWindingNumberBySolidAngles) {
  // An hourglass with an off-centre cavity: two components, the inner turned inside out.
  Triangles mesh = Revolve({{-100, 80}, {-20, 15}, {30, 20}, {90, 70}}, 13);
  const Triangles cavity = Moved(BoxMesh({20, 20, 30}), At(5, 5, -75));
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
  for (const auto& f : cavity.faces) mesh.faces.push_back({first + f[0], first + f[2], first + f[1]});
  const Solid solid(mesh);
  ASSERT_TRUE(solid.closed());
  EXPECT_EQ(solid.representatives().size(), 2u);
  RandomStream random(5, 0);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d p{random.Uniform(-90, 90), random.Uniform(-90, 90), random.Uniform(-110, 100)};
    const bool truth = std::abs(Winding(mesh, p)) > 0.5;
    EXPECT_EQ(solid.Contains(p), truth) << p.transpose();
    inside += truth;
  }
  EXPECT_GT(inside, 300);
  EXPECT_FALSE(solid.Contains({5, 5, -75}));
}

TEST(Solid, OpenMeshIsASheet) {
  Triangles mesh = BoxMesh({10, 10, 10});
  mesh.faces.pop_back();
  const Solid solid(mesh);
  EXPECT_FALSE(solid.closed());
  EXPECT_FALSE(solid.Contains(Eigen::Vector3d::Zero()));
}

TEST(Solid, UnweldedFacetsOfAnStlAreWelded) {
  const Triangles box = BoxMesh({10, 10, 10});
  Triangles soup;
  for (const auto& f : box.faces) {
    const int first = static_cast<int>(soup.vertices.size());
    for (int v : f) soup.vertices.push_back(box.vertices[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  const Solid solid(soup);
  EXPECT_TRUE(solid.closed());
  EXPECT_EQ(solid.representatives().size(), 1u);
  // Rays from the centre along the tried directions meet corners and diagonals of other boxes, so also probe
  // points in line with vertices.
  for (double t = -4.9; t < 5; t += 0.1) EXPECT_TRUE(solid.Contains({t, t, t}));
  EXPECT_FALSE(solid.Contains({5.1, 5.1, 5.1}));
}

TEST(Solid, OverlappingShellsAreInsideWhereTheyOverlap) {
  Triangles two = BoxMesh({10, 10, 10});
  for (const auto& v : BoxMesh({10, 10, 10}).vertices) two.vertices.push_back(v + Eigen::Vector3d(4, 1, 1));
  for (const auto& f : BoxMesh({10, 10, 10}).faces) two.faces.push_back({f[0] + 8, f[1] + 8, f[2] + 8});
  EXPECT_TRUE(Solid(two).Contains({2, 0.3, 0.2}));
}

}  // namespace
}  // namespace millpose::test
