// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/region.hpp"

#include "base/error.hpp"
#include "base/random.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

const Mesh kGrid = SoundMesh(GridShape(10, 10, 10));  // 0..100 in x and y

RegionOptions InBox(double x0, double y0, double x1, double y1) {
  RegionOptions options;
  options.box = RegionBox{Eigen::Vector3d(x0, y0, -1), Eigen::Vector3d(x1, y1, 1)};
  return options;
}

// The region as a set of points, by a predicate to compare with; also that margins change by 1 mm per mm at
// most.
void ExpectSame(const RegionOptions& options, const std::function<bool(double, double)>& expected) {
  const Region region(kGrid, options);
  RandomStream random(9, 0);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d p{random.Uniform(0, 100), random.Uniform(0, 100), 0};
    const int face = kGrid.Closest(p).face;
    const double margin = region.Margin(face, p);
    EXPECT_EQ(region.HasFace(face) && margin >= 0, expected(p.x(), p.y())) << p.transpose();
    inside += margin >= 0 ? 1 : 0;
    const Eigen::Vector3d q = p + Eigen::Vector3d{random.Uniform(-3, 3), random.Uniform(-3, 3), 0};
    if (std::isfinite(margin)) {
      EXPECT_LE(std::abs(region.Margin(face, q) - margin), (q - p).norm() + 1e-9);
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_LT(inside, 3900);
}

TEST(Region, HalfSpace) {
  RegionOptions options;
  options.half_space = {{30, 40, 0}, Eigen::Vector3d(0.6, 0.8, 0)};
  ExpectSame(options, [](double x, double y) { return 0.6 * (x - 30) + 0.8 * (y - 40) >= 0; });
}

TEST(Region, MarginsAreWaysOnTheFace) {
  const Eigen::Vector3d p(50, 50, 0);
  const int face = kGrid.Closest(p).face;
  RegionOptions slanted;
  slanted.half_space = {{30, 0, 0}, Eigen::Vector3d(1, 0, 1).normalized()};
  EXPECT_NEAR(Region(kGrid, slanted).Margin(face, p), 20, 1e-9);
  RegionOptions flat;  // a box that the face runs along
  flat.box = RegionBox{Eigen::Vector3d(10, -500, -0.01), Eigen::Vector3d(500, 500, 0.01)};
  EXPECT_NEAR(Region(kGrid, flat).Margin(face, p), 40, 1e-9);
  flat.box = RegionBox{Eigen::Vector3d(10, -500, 0), Eigen::Vector3d(500, 500, 1)};  // and ends in it
  EXPECT_NEAR(Region(kGrid, flat).Margin(face, p), 40, 1e-9);
  flat.box = RegionBox{Eigen::Vector3d(10, -500, 0.01), Eigen::Vector3d(500, 500, 1)};
  EXPECT_LT(Region(kGrid, flat).Margin(face, p), -1e6);
  RegionOptions projected;  // its corners lie 10 mm over the face and come down slanted, at x = 20 and 120
  projected.polygon = {{{30, -500, 10}, {130, -500, 10}, {130, 500, 10}, {30, 500, 10}},
                       Eigen::Vector3d(1, 0, 1).normalized()};
  EXPECT_NEAR(Region(kGrid, projected).Margin(face, p), 30, 1e-9);
}

TEST(Region, ConcavePolygonAlongADirection) {
  RegionOptions options;
  options.polygon = {{{10, 10, 5}, {80, 10, -7}, {80, 30, 0}, {30, 30, 0}, {30, 90, 3}, {10, 90, 0}},
                     Eigen::Vector3d::UnitZ()};
  ExpectSame(options, [](double x, double y) {
    return (x >= 10 && x <= 80 && y >= 10 && y <= 30) || (x >= 10 && x <= 30 && y >= 10 && y <= 90);
  });
}

TEST(Region, CombinationsByAllAnyNone) {
  RegionOptions options;
  options.all = {InBox(5, 5, 95, 95)};
  options.any = {InBox(0, 0, 50, 50), InBox(40, 40, 100, 100)};
  options.none = {InBox(20, 20, 60, 60), InBox(70, 70, 75, 75)};
  ExpectSame(options, [](double x, double y) {
    const auto in = [&](double x0, double y0, double x1, double y1) {
      return x >= x0 && x <= x1 && y >= y0 && y <= y1;
    };
    return in(5, 5, 95, 95) && (in(0, 0, 50, 50) || in(40, 40, 100, 100)) && !in(20, 20, 60, 60) &&
           !in(70, 70, 75, 75);
  });
}

TEST(Region, NoneOfAFacingLeavesTheOtherFaces) {
  const Mesh box = SoundMesh(BoxShape({0, 0, 0}, {1, 2, 3}));
  RegionOptions up;
  up.facing = Eigen::Vector3d::UnitZ();
  RegionOptions options;
  options.none = {up};
  const Region region(box, options);
  for (int face = 0; face < box.face_count(); ++face)
    EXPECT_EQ(region.HasFace(face), box.FaceNormal(face).z() < 0.5);
}

TEST(Region, FloodFillStopsAtCreases) {
  const Mesh cylinder = SoundMesh(CylinderShape(50, 30, 72, 2));
  RegionOptions options;
  options.connected = {{60, 0, 15}, DegToRad(20)};
  const Region wall(cylinder, options);
  options.connected = {{0, 0, 40}, DegToRad(20)};
  const Region cap(cylinder, options);
  for (int face = 0; face < cylinder.face_count(); ++face) {
    EXPECT_EQ(wall.HasFace(face), std::abs(cylinder.FaceNormal(face).z()) < 0.5);
    EXPECT_EQ(cap.HasFace(face), cylinder.FaceNormal(face).z() > 0.5);
  }
}

TEST(Region, RimDistanceCountsFromBordersOfFaceSets) {
  const Mesh cylinder = SoundMesh(CylinderShape(50, 30, 72, 2));
  RegionOptions options;
  options.connected = {{60, 0, 15}, DegToRad(20)};
  options.rim_distance = 4;
  const Region wall(cylinder, options);
  const Eigen::Vector3d p(50, 0, 10);
  EXPECT_NEAR(wall.Margin(cylinder.Closest(p).face, p), 6, 1e-9);
}

TEST(Region, RimDistanceIsAConditionAsOthers) {
  // The strip within 10 mm of the grid's rim: not what is farther.
  const Mesh grid = SoundMesh(GridShape(10, 10, 10));
  RegionOptions inner, options;
  inner.rim_distance = 10;
  options.none = {inner};
  const Region strip(grid, options);
  for (const auto& [x, margin] : {std::pair(5.0, 5.0), std::pair(12.0, -2.0), std::pair(50.0, -40.0)}) {
    const Eigen::Vector3d p(x, 50, 0);
    EXPECT_NEAR(strip.Margin(grid.Closest(p).face, p), margin, 1e-9);
  }
}

TEST(Region, RefusesPolygonsWithoutArea) {
  RegionOptions options;
  options.polygon = {{{0, 0, 0}, {1, 0, 0}, {1, 0, 5}}, Eigen::Vector3d::UnitZ()};
  EXPECT_THROW(Region(kGrid, options), InputError);
}

}  // namespace
}  // namespace millpose
