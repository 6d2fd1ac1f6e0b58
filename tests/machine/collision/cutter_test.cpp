// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/cutter.hpp"

#include "tests/machine/collision/brute_force.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

/// Largest value of d·p over the points.
double Support(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& d) {
  double best = -1e300;
  for (const auto& p : points) best = std::max(best, d.dot(p));
  return best;
}

TEST(Cutter, PartAboveAHeightContainsTheShapeAboveItAndLittleMore) {
  const std::vector<std::pair<Shape, Triangles>> shapes{
      {Box{{20, 30, 50}}, BoxMesh({20, 30, 50})},
      {Sphere{20}, CapsuleMesh(20, 0, 96)},
      {Capsule{10, 30}, CapsuleMesh(10, 30, 96)},
      {Cylinder{12, 60}, Revolve({{-30, 12}, {30, 12}}, 96)},
      {Cone{5, 15, 50}, Revolve({{-25, 5}, {25, 15}}, 96)},
      {BoxMesh({20, 30, 50}), BoxMesh({20, 30, 50})}};
  RandomStream random(2, 0);
  for (size_t i = 0; i < shapes.size(); ++i) {
    for (const bool upright : {true, false}) {
      const Pose X_TG = upright ? At(3, -2, 25) : RandomPose(random, 10);
      const double z = X_TG.translation().z() + 4;
      const auto above = AboveHeight(shapes[i].first, X_TG, z);
      ASSERT_TRUE(above);
      // Samples of the shape above the height: points between vertices of its mesh.
      const Triangles mesh = Moved(shapes[i].second, X_TG);
      std::vector<Eigen::Vector3d> samples;
      for (const auto& a : mesh.vertices) {
        for (const auto& b :
             {mesh.vertices[0], mesh.vertices[mesh.vertices.size() / 2], mesh.vertices.back(), a}) {
          if (a.z() > z) samples.push_back(a);
          if ((a.z() > z) != (b.z() > z)) samples.push_back(a + (b - a) * ((z - a.z()) / (b.z() - a.z())));
        }
      }
      for (int k = 0; k < 100; ++k) {
        Eigen::Vector3d d{random.Normal(), random.Normal(), random.Normal()};
        d.normalize();
        EXPECT_GE(Support(above->points, d), Support(samples, d) - 1e-6) << "shape " << i;
        EXPECT_LE(Support(above->points, d), Support(mesh.vertices, d) + 0.01 * 20) << "shape " << i;
      }
      for (const auto& p : above->points) EXPECT_GE(p.z(), z - 1e-9);
    }
  }
}

TEST(Cutter, NothingIsAboveItsTop) {
  EXPECT_FALSE(AboveHeight(Cylinder{10, 60}, At(0, 0, 30), 60));
  EXPECT_TRUE(AboveHeight(Cylinder{10, 60}, At(0, 0, 30), 59.9));
}

}  // namespace
}  // namespace millpose::test
