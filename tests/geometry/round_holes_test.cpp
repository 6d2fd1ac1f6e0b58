// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/round_holes.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

constexpr double kCrease = DegToRad(30), kTolerance = 0.02;

std::vector<RoundHole> Holes(const Triangles& part) {
  return FindRoundHoles(SoundMesh(part), kCrease, kTolerance);
}

// A round block of radius 30 from z = 0 to 20 with a hole of radius r through it.
Triangles Through(double r, int count) {
  return LatheShape({{r, 0}, {30, 0}, {30, 20}, {r, 20}, {r, 0}}, count);
}

Eigen::Isometry3d Somewhere(RandomStream& random) {
  const auto number = [&] { return 2 * random.Uniform() - 1; };
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(number(), number(), number(), number()).normalized().toRotationMatrix();
  X.translation() = 2000 * Eigen::Vector3d(number(), number(), number());
  return X;
}

// The hole's axis as a line: how far two points 20 mm apart on it lie from the line through p along d.
double OffAxis(const RoundHole& hole, const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
  const auto off = [&](const Eigen::Vector3d& q) { return (q - p - d.dot(q - p) * d).norm(); };
  return std::max(off(hole.entrance), off(hole.entrance - 20 * hole.axis));
}

TEST(RoundHoles, LieOnTheirAxesWithinAMicrometre) {
  RandomStream random(1, 7);
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Isometry3d X = Somewhere(random);
    const double r = 1 + 9 * random.Uniform();
    Triangles part = Moved(Through(r, 13 + trial), X);
    const bool as_stl = trial % 2 == 1;  // with coordinates of 24 bits, 0.1 µm apart at 2 m
    if (as_stl)
      for (Eigen::Vector3d& p : part.vertices) p = p.cast<float>().cast<double>();
    const std::vector<RoundHole> holes = Holes(part);
    ASSERT_EQ(holes.size(), 1) << trial;
    const double least = as_stl ? 1e-3 : 1e-8;
    EXPECT_LT(OffAxis(holes[0], X.translation(), X.linear().col(2)), least) << trial << " r " << r;
    EXPECT_NEAR(holes[0].diameter, 2 * r, least);
    EXPECT_NEAR(holes[0].depth, 20, least);
    EXPECT_EQ(holes[0].kind, HoleKind::kThrough);
  }
}

TEST(RoundHoles, BlindOnesOpenOnOneSide) {
  const std::vector<std::vector<Eigen::Vector2d>> bottoms{{{0, 8}}, {{0, 6.2}}};  // flat, drilled
  for (const auto& bottom : bottoms) {
    std::vector<Eigen::Vector2d> profile{{0, 0}, {30, 0}, {30, 20}, {4, 20}, {4, 8}};
    profile.insert(profile.end(), bottom.begin(), bottom.end());
    for (const double turn : {0.0, kPi}) {
      const Eigen::Isometry3d X(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX()));
      const std::vector<RoundHole> holes = Holes(Moved(LatheShape(profile, 48), X));
      ASSERT_EQ(holes.size(), 1);
      EXPECT_EQ(holes[0].kind, HoleKind::kBlind);
      EXPECT_LT((holes[0].axis - X.linear().col(2)).norm(), 1e-9);
      EXPECT_LT((holes[0].entrance - X * Eigen::Vector3d(0, 0, 20)).norm(), 1e-9);
      EXPECT_NEAR(holes[0].depth, 12, 1e-9);
    }
  }
}

TEST(RoundHoles, AConicalMouthBelongsToTheHole) {
  const std::vector<RoundHole> holes =
      Holes(LatheShape({{4, 0}, {30, 0}, {30, 20}, {7, 20}, {4, 17}, {4, 0}}, 36));
  ASSERT_EQ(holes.size(), 1);
  EXPECT_NEAR(holes[0].diameter, 8, 1e-9);
  EXPECT_NEAR(holes[0].entrance.z(), 20, 1e-9);
  EXPECT_NEAR(holes[0].depth, 20, 1e-9);
}

TEST(RoundHoles, RimsOfSheetsCountAndTheirBordersDoNot) {
  const std::vector<RoundHole> holes = Holes(LatheShape({{40, 3}, {5, 3}}, 40));
  ASSERT_EQ(holes.size(), 1);
  EXPECT_EQ(holes[0].kind, HoleKind::kRim);
  EXPECT_NEAR(holes[0].diameter, 10, 1e-9);
  EXPECT_LT((holes[0].entrance - Eigen::Vector3d(0, 0, 3)).norm(), 1e-9);
  EXPECT_LT((holes[0].axis - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(RoundHoles, WhatIsNotRoundIsNone) {
  EXPECT_TRUE(Holes(CylinderShape(10, 20, 48)).empty()) << "a peg";
  EXPECT_TRUE(Holes(Through(5, 6)).empty()) << "a hexagon";
  EXPECT_TRUE(Holes(LatheShape({{5, 0}, {30, 0}, {30, 20}, {6, 20}, {5, 0}}, 48)).empty()) << "a taper";
  EXPECT_TRUE(Holes(BoxShape({0, 0, 0}, {10, 10, 10})).empty());
  Triangles half = Through(5, 48);
  std::erase_if(half.faces, [&](const std::array<int, 3>& face) {
    return std::ranges::any_of(face,
                               [&](int v) { return half.vertices[static_cast<size_t>(v)].y() < -1e-6; });
  });
  EXPECT_TRUE(FindRoundHoles(SoundMesh(half), kCrease, kTolerance).empty()) << "half a hole";
}

TEST(RoundHoles, CornersOffTheCircleCountUpToTheTolerance) {
  Triangles part = Through(5, 48);
  RandomStream random(1, 3);
  for (Eigen::Vector3d& p : part.vertices)
    p += 0.005 * Eigen::Vector3d(random.Uniform() - 0.5, random.Uniform() - 0.5, 0);
  const std::vector<RoundHole> holes = Holes(part);
  ASSERT_EQ(holes.size(), 1);
  EXPECT_GT(holes[0].residual, 1e-4);
  EXPECT_LE(holes[0].residual, 0.006);
  EXPECT_TRUE(FindRoundHoles(SoundMesh(part), kCrease, 1e-4).empty());
}

}  // namespace
}  // namespace millpose
