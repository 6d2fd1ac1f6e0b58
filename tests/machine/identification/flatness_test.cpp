// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/flatness.hpp"

#include <Eigen/Eigenvalues>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "machine/identification/minimum_zone.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Points scattered about a random plane, `noise` mm high.
Points RandomFace(RandomStream& stream, int count, double noise) {
  const Vector3d n = RandomUnit(stream), u = n.unitOrthogonal(), v = n.cross(u);
  const Vector3d centre = 1000 * RandomUnit(stream);
  Points points;
  for (int i = 0; i < count; ++i)
    points.push_back(centre + stream.Uniform(-40, 40) * u + stream.Uniform(-40, 40) * v +
                     stream.Uniform(-noise, noise) * n);
  return points;
}

double Extent(const Points& points, const Vector3d& direction) {
  double low = 1e300, high = -1e300;
  for (const Vector3d& point : points) {
    low = std::min(low, direction.dot(point));
    high = std::max(high, direction.dot(point));
  }
  return high - low;
}

TEST(Flatness, LeastSquaresPlaneAgreesWithTheCovariance) {
  RandomStream stream(1, 0);
  for (int k = 0; k < OfTier(60, 1000); ++k) {
    const Points points = RandomFace(stream, 8, 1);
    const auto found = MeasureFlatness(points);
    ASSERT_TRUE(found.has_value());
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& point : points) mean += point / 8;
    Matrix3d covariance = Matrix3d::Zero();
    for (const Vector3d& point : points) covariance += (point - mean) * (point - mean).transpose() / 8;
    const EigenPairs3 pairs = EigenOfSymmetric3(covariance);
    EXPECT_LT(found->normal.cross(pairs.vectors.col(0)).norm(), 1e-9);
    EXPECT_EQ(found->normal.maxCoeff(), found->normal.cwiseAbs().maxCoeff());
    EXPECT_NEAR(found->rms, std::sqrt(pairs.values[0]), 1e-9);
    EXPECT_NEAR(found->flatness, Extent(points, pairs.vectors.col(0)), 1e-8);
    EXPECT_LE(found->minimum_zone, found->flatness * (1 + 1e-12));
    EXPECT_NEAR(found->minimum_zone, Extent(points, found->zone_normal), 1e-9);
  }
}

/// The least extent over all planes through three points and all pairs of edges' common normals: one of them
/// is it.
double BruteForceZone(const Points& points) {
  double least = 1e300;
  const auto consider = [&](const Vector3d& normal) {
    if (normal.norm() > 1e-9) least = std::min(least, Extent(points, normal.normalized()));
  };
  Points edges;
  for (size_t i = 0; i < points.size(); ++i)
    for (size_t j = 0; j < i; ++j) edges.push_back(points[i] - points[j]);
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t j = 0; j < i; ++j) consider(edges[i].cross(edges[j]));
  return least;
}

TEST(Flatness, MinimumZoneAgreesWithBruteForce) {
  RandomStream stream(2, 0);
  for (int k = 0; k < 60; ++k) {
    const Points points = RandomFace(stream, 5 + stream.Below(6), k % 2 == 0 ? 0.1 : 30);
    EXPECT_NEAR(MeasureFlatness(points)->minimum_zone, BruteForceZone(points), 1e-9);
  }
}

TEST(Flatness, OfKnownBodies) {
  // A regular tetrahedron's width is the distance of two opposite edges: a/√2.
  const Points tetrahedron{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_NEAR(MeasureFlatness(tetrahedron)->minimum_zone, 2, 1e-15);
  const Points box{{0, 0, 0},   {10, 0, 0},   {0, 20, 0},   {10, 20, 0},
                   {0, 0, 0.5}, {10, 0, 0.5}, {0, 20, 0.5}, {10, 20, 0.5}};
  EXPECT_NEAR(MeasureFlatness(box)->minimum_zone, 0.5, 1e-15);
  EXPECT_NEAR(MeasureFlatness(box)->flatness, 0.5, 1e-12);
  EXPECT_NEAR(MeasureFlatness(box)->rms, 0.25, 1e-12);
  // One raised corner of a square, by 1: the least-squares plane sees ±1/4 all round, the zone 1/2.
  const Points corner{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}, {100, 100, 1}};
  EXPECT_NEAR(MeasureFlatness(corner)->flatness, 0.5, 1e-4);
  EXPECT_NEAR(MeasureFlatness(corner)->minimum_zone, 0.5, 1e-4);
}

TEST(Flatness, SeesATenthOfAMicrometreOnAMetre) {
  Points points;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) points.emplace_back(111.0 * i, 111.0 * j, (i + j) % 2 == 0 ? 0 : 1e-4);
  EXPECT_NEAR(MeasureFlatness(points)->flatness, 1e-4, 1e-5);
}

TEST(Flatness, ListsOutliersAndRefusesLines) {
  RandomStream stream(3, 0);
  Points points = RandomFace(stream, 100, 0.01);
  points[17] += 0.5 * MeasureFlatness(points)->normal;
  EXPECT_EQ(MeasureFlatness(points)->outliers, std::vector<size_t>{17});
  EXPECT_FALSE(MeasureFlatness({{0, 0, 0}, {1, 0, 0}}).has_value());
  EXPECT_FALSE(MeasureFlatness({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {-3, -3, 0}}).has_value());
  EXPECT_FALSE(MeasureFlatness({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}).has_value());
  const auto flat = MeasureFlatness({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  ASSERT_TRUE(flat.has_value());
  EXPECT_EQ(flat->minimum_zone, 0);
  EXPECT_LT(flat->flatness, 1e-15);
}

TEST(Flatness, OutliersBeginAtThreeAndAHalfRobustDeviations) {
  Points points;  // every distance 0.01 from the plane, so the bound is 3.5/0.6745·0.01 = 0.0519
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) points.emplace_back(10.0 * i, 10.0 * j, (i + j) % 2 == 0 ? 0.01 : -0.01);
  points.emplace_back(95, 95, 0.045);
  points.emplace_back(95, 95, -0.045);
  EXPECT_TRUE(MeasureFlatness(points)->outliers.empty());
  points.emplace_back(95, 95, 0.06);
  points.emplace_back(95, 95, -0.06);
  EXPECT_EQ(MeasureFlatness(points)->outliers, (std::vector<size_t>{402, 403}));
}

}  // namespace
}  // namespace millpose
