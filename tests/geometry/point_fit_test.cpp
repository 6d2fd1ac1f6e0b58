// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/point_fit.hpp"

#include "base/random.hpp"

namespace millpose {
namespace {

std::vector<Eigen::Vector3d> Cloud(RandomStream& random, int count, const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(size.x() * random.Uniform(), size.y() * random.Uniform(),
                        size.z() * random.Uniform());
  return points;
}

TEST(PointFit, FindsTheMotionAlsoOfPlaneTargets) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream random(seed, 0);
    const auto from = Cloud(random, 3 + random.Below(5), {900, 600, seed % 2 == 0 ? 0.0 : 80.0});
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translate(Eigen::Vector3d(1750, 20, 1200));
    X.rotate(Eigen::AngleAxisd(random.Uniform(-3, 3),
                               Eigen::Vector3d{random.Normal(), random.Normal(), 1}.normalized()));
    std::vector<Eigen::Vector3d> to;
    for (const auto& p : from) to.push_back(X * p);
    const auto fit = FitPoints(from, to);
    ASSERT_TRUE(fit);
    EXPECT_LT((fit->X.matrix() - X.matrix()).norm(), 1e-8);
    EXPECT_LT(fit->largest, 1e-8);
    EXPECT_NEAR(fit->X.linear().determinant(), 1, 1e-12);
  }
}

TEST(PointFit, NoSmallMotionFitsNoisyTargetsBetter) {
  RandomStream random(5, 0);
  const auto from = Cloud(random, 6, {900, 600, 50});
  std::vector<Eigen::Vector3d> to = from;
  for (auto& p : to) p += 0.1 * Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()};
  const auto fit = FitPoints(from, to);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->rms, 0.01);
  for (int i = 0; i < 200; ++i) {
    Eigen::Isometry3d near = fit->X;
    near.translate(0.01 * Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()});
    near.rotate(Eigen::AngleAxisd(1e-4 * random.Normal(), Eigen::Vector3d::Unit(random.Below(3))));
    double squares = 0;
    for (size_t k = 0; k < from.size(); ++k) squares += (near * from[k] - to[k]).squaredNorm();
    EXPECT_GE(std::sqrt(squares / 6), fit->rms - 1e-12);
  }
}

TEST(PointFit, RefusesWhatLeavesTheRotationOpen) {
  EXPECT_FALSE(FitPoints({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(FitPoints({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
  EXPECT_FALSE(FitPoints({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0}}));
}

}  // namespace
}  // namespace millpose
