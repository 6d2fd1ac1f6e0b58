// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/corner.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/units.hpp"
#include "machine/motion/line.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Pose Place(const Vector3d& p, const Vector3d& rotation = Vector3d::Zero()) {
  Pose pose = Pose::Identity();
  pose.translation() = p;
  const double angle = rotation.norm();
  if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  return pose;
}

/// The largest distance from the two motions of a parabola with tangents of length `reach` on both.
double FarthestOfParabola(const Vector3d& a, const Vector3d& corner, const Vector3d& b, double reach) {
  const Vector3d in = (corner - a).normalized(), out = (b - corner).normalized();
  double farthest = 0;
  for (int i = 0; i <= 2000; ++i) {
    const double t = i / 2000.0;
    const Vector3d p = corner - (1 - t) * (1 - t) * reach * in + t * t * reach * out;
    const auto to_line = [&](const Vector3d& along, double least, double most) {
      return (p - corner - std::clamp((p - corner).dot(along), least, most) * along).norm();
    };
    farthest = std::max(farthest,
                        std::min(to_line(in, -(corner - a).norm(), 0), to_line(out, 0, (b - corner).norm())));
  }
  return farthest;
}

TEST(Corner, AStraightPathHasNone) {
  const Corner corner = CornerBetween(Place({0, 0, 0}), Place({3, 0, 0}), Place({10, 0, 0}));
  EXPECT_EQ(corner.shorter, 3);
  EXPECT_NEAR(corner.bend, 0, 1e-15);
  EXPECT_EQ(LargestReach(corner, {0.001, 1e-6}), 1.5);
  EXPECT_EQ(RoundedBy(corner, 5).position, 0);
}

TEST(Corner, AnEvenTurnAlongALineIsNone) {
  // 0.01 rad per mm before and behind.
  const Corner corner =
      CornerBetween(Place({0, 0, 0}), Place({3, 0, 0}, {0, 0, 0.03}), Place({5, 0, 0}, {0, 0, 0.05}));
  EXPECT_NEAR(corner.twist, 0, 1e-12);
  const Corner sudden = CornerBetween(Place({0, 0, 0}), Place({3, 0, 0}), Place({5, 0, 0}, {0, 0, 0.02}));
  EXPECT_NEAR(sudden.twist, 0.01, 1e-12);
  EXPECT_NEAR(RoundedBy(sudden, 0.4).angle, 0.001, 1e-12);
}

TEST(Corner, WithoutLengthNothingIsRounded) {
  const Corner corner = CornerBetween(Place({0, 0, 0}), Place({0, 0, 0}, {0, 0, 1}), Place({5, 0, 0}));
  EXPECT_EQ(LargestReach(corner, {}), 0);
  EXPECT_EQ(CornerSpeed(corner, 1, {}), 0);
}

TEST(Corner, TheEnvelopeCoversAParabolaWalkedDensely) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 40; ++i) {
    const auto vector = [&] { return Vector3d(number(random), number(random), number(random)); };
    const Vector3d a = vector() * 10, middle = vector(), b = vector() * 10;
    const Corner corner = CornerBetween(Place(a), Place(middle), Place(b));
    const double reach = LargestReach(corner, {0.5, 1});
    const double covered = RoundedBy(corner, reach).position;
    EXPECT_LE(FarthestOfParabola(a, middle, b, reach), covered + 1e-12);
    // The corner itself is passed at just that distance.
    const Vector3d in = (middle - a).normalized(), out = (b - middle).normalized();
    EXPECT_NEAR((0.25 * reach * (out - in)).norm(), covered, 1e-12);
    EXPECT_LE(covered, 0.5 + 1e-12);
    // It is the largest one: a hundredth more leaves the tolerance, or the half of a motion.
    EXPECT_TRUE(reach == corner.shorter / 2 || RoundedBy(corner, 1.01 * reach).position > 0.5);
  }
}

TEST(Corner, ARightAngleInNumbers) {
  const Corner corner = CornerBetween(Place({0, 0, 0}), Place({10, 0, 0}), Place({10, 20, 0}));
  EXPECT_NEAR(corner.bend, std::sqrt(2), 1e-12);
  EXPECT_NEAR(LargestReach(corner, {0.016, 1}), 4 * 0.016 / std::sqrt(2), 1e-12);
  EXPECT_EQ(LargestReach(corner, {10, 1}), 5);
}

TEST(Corner, SpeedFollowsCycleAndAcceleration) {
  const Corner straight{10, 0, 0}, right_angle{10, std::sqrt(2), 0};
  PathDynamics dynamics;
  // 0.12 mm are one cycle of 12 ms at 600 mm/min.
  EXPECT_NEAR(CornerSpeed(straight, 0.12, dynamics) * 60, 600, 1e-9);
  dynamics.cycle = 1e-6;
  // Over 2·reach the velocity turns by √2·v: a = √2·v²/(2·reach).
  const double speed = CornerSpeed(right_angle, 0.5, dynamics);
  EXPECT_NEAR(std::sqrt(2) * speed * speed / (2 * 0.5), dynamics.acceleration, 1e-9);
  EXPECT_EQ(CornerSpeed(right_angle, 0, dynamics), 0);
  // Farther than half of the shorter motion nothing is rounded.
  EXPECT_EQ(CornerSpeed(right_angle, 100, dynamics), CornerSpeed(right_angle, 5, dynamics));
  EXPECT_NEAR(BlockSpeed(0.3, PathDynamics()), 25, 1e-12);
}

TEST(Corner, WritersKeepAMargin) {
  const PathTolerance written = WrittenTolerance({0.05, 0.001});
  EXPECT_LT(written.position, 0.05);
  EXPECT_LT(written.angle, 0.001);
  EXPECT_NEAR(written.position / 0.05, written.angle / 0.001, 1e-12);
}

}  // namespace
}  // namespace millpose
