// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/surface_rays.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Region Whole(Triangles triangles) { return {Mesh(std::move(triangles)), RegionOptions{}}; }

// Every place of the lattice that lies on the grid once: also those on the diagonals of its squares, which
// two triangles share.
TEST(SurfaceRays, LieOnAPlaneOnceEach) {
  const Region region = Whole(GridShape(6, 4, 2));  // 12 × 8 mm, diagonals through the lattice
  const std::vector<SurfaceRay> rays = RaysOver(region, 1);
  EXPECT_EQ(rays.size(), 12u * 8u);
  EXPECT_EQ(CountRays(region, 1), 12 * 8);
  std::set<std::pair<double, double>> places;
  for (const SurfaceRay& ray : rays) {
    EXPECT_EQ(ray.normal, Vector3d::UnitZ());
    EXPECT_EQ(ray.origin.z(), 0);
    places.emplace(ray.origin.x(), ray.origin.y());
  }
  EXPECT_EQ(places.size(), rays.size());
}

TEST(SurfaceRays, HaveTheirNeighboursBesideThem) {
  const double spacing = 0.75;
  const std::vector<SurfaceRay> rays = RaysOver(Whole(GridShape(3, 3, 2)), spacing);
  const auto next = NextRays(rays, spacing);
  size_t pairs = 0;
  for (size_t i = 0; i < rays.size(); ++i)
    for (const int other : next[i]) {
      if (other < 0) continue;
      ++pairs;
      EXPECT_NEAR((rays[static_cast<size_t>(other)].origin - rays[i].origin).norm(), spacing, 1e-12);
    }
  const size_t side = 8;  // places of the lattice on 6 mm
  EXPECT_EQ(rays.size(), side * side);
  EXPECT_EQ(pairs, 2 * side * (side - 1));
}

// From each of six sides; on a sphere the lattices cover the whole of it, less than √3 times as far apart.
TEST(SurfaceRays, CoverAllSidesOfASphere) {
  const double radius = 20, spacing = 1;
  const Region region = Whole(SphereShape(radius, 24));
  const std::vector<SurfaceRay> rays = RaysOver(region, spacing);
  EXPECT_NEAR(static_cast<double>(rays.size()), CountRays(region, spacing), 0.03 * rays.size());
  std::set<int> sides;
  for (const SurfaceRay& ray : rays) {
    sides.insert(ray.side);
    EXPECT_NEAR(region.mesh().Closest(ray.origin).distance, 0, 1e-12);
    EXPECT_GT(ray.normal.dot(ray.origin), 0);
  }
  EXPECT_EQ(sides.size(), 6u);
  for (const Vector3d& place : {Vector3d(1, 1, 1), Vector3d(-1, 1, 0.3), Vector3d(0.2, -1, -0.9)}) {
    const Vector3d p = radius * place.normalized();
    const auto nearest =
        std::ranges::min_element(rays, {}, [&](const SurfaceRay& ray) { return (ray.origin - p).norm(); });
    EXPECT_LT((nearest->origin - p).norm(), 2 * spacing);
  }
}

TEST(SurfaceRays, KeepToTheRegion) {
  RegionOptions options;
  options.rim_distance = 2;
  const Region region(Mesh(GridShape(5, 5, 2)), options);
  for (const SurfaceRay& ray : RaysOver(region, 0.5))
    EXPECT_LE((ray.origin - Vector3d(5, 5, 0)).cwiseAbs().maxCoeff(), 3);
}

}  // namespace
}  // namespace millpose
