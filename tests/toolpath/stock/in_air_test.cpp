// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/in_air.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const Vector3d kBlock{60, 40, 20};  // from the origin

CutterMotion UprightWay(const Vector3d& from, const Vector3d& to) {
  return {{from, Vector3d::UnitZ()}, {to, Vector3d::UnitZ()}, 0};
}

InAir OverTheBlock(double height) {
  const StandingStock stock(BoxShape(Vector3d::Zero(), kBlock), 0.5);
  return AirCheck({10, 2, 40}, 5, 0.5).Of(UprightWay({-5, 20, 20 + height}, {65, 20, 20 + height}), stock);
}

TEST(AirCheck, TellsWhatACutterOverABlockMeets) {
  EXPECT_EQ(OverTheBlock(-1), InAir::kCuts);
  EXPECT_EQ(OverTheBlock(-0.1), InAir::kCuts);
  EXPECT_EQ(OverTheBlock(-0.02), InAir::kTouches);
  EXPECT_EQ(OverTheBlock(0), InAir::kTouches);
  EXPECT_EQ(OverTheBlock(4.9), InAir::kTouches);
  EXPECT_EQ(OverTheBlock(6), InAir::kClear);
}

// What it has cut itself, and what it went through before, are air.
TEST(AirCheck, WhatIsMilledIsGone) {
  StandingStock stock(BoxShape(Vector3d::Zero(), kBlock), 0.5);
  const CutterShape wide{15, 0, 40};
  const AirCheck check({4, 0, 40}, 5, 0.5);
  const CutterMotion along = UprightWay({15, 20, 10}, {45, 20, 10});
  EXPECT_EQ(check.Of(along, stock), InAir::kCuts);
  stock.Remove(wide, std::vector<CutterMotion>{along}, 1);
  EXPECT_EQ(check.Of(along, stock), InAir::kTouches);  // it stands on the floor
  EXPECT_EQ(check.Of(UprightWay({15, 20, 16.5}, {45, 20, 16.5}), stock), InAir::kClear);
  EXPECT_EQ(check.Of(UprightWay({15, 20, 16.5}, {45, 28, 16.5}), stock),
            InAir::kTouches);  // 3 mm from the wall
}

/// The distance of a place from the block.
double FromBlock(const Vector3d& place) {
  return (place - place.cwiseMax(Vector3d::Zero()).cwiseMin(kBlock)).norm();
}

/// No less than the distance of what a cutter sweeps from the block: by places all over it.
double DistanceOf(const CutterShape& cutter, const CutterMotion& motion) {
  constexpr int kSteps = 40, kAngles = 48, kHeights = 24, kCorner = 8;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const Vector3d tip = motion.from.tip + share * (motion.to.tip - motion.from.tip);
    const Vector3d axis = (motion.from.axis + share * (motion.to.axis - motion.from.axis)).normalized();
    const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
    const auto ring = [&](double radius, double height) {
      for (int k = 0; k < kAngles; ++k) {
        const double angle = 2 * std::numbers::pi * k / kAngles;
        least = std::min(
            least, FromBlock(tip + height * axis + radius * (std::cos(angle) * u + std::sin(angle) * v)));
      }
    };
    const double r = cutter.corner_radius;
    for (int k = 0; k <= kCorner; ++k) {
      const double turn = std::numbers::pi / 2 * k / kCorner;
      ring(cutter.radius - r + r * std::sin(turn), r - r * std::cos(turn));
      ring((cutter.radius - r) * k / kCorner, 0);
      ring(cutter.radius * k / kCorner, cutter.length);
    }
    for (int k = 0; k <= kHeights; ++k) ring(cutter.radius, r + (cutter.length - r) * k / kHeights);
  }
  return least;
}

// Motions of any direction whose axes lean and turn: none within the margin is clear, and all are that are
// farther away than the lattice can miss.
TEST(AirCheck, IsClearOnlyBeyondTheMargin) {
  constexpr double kMargin = 3, kSpacing = 0.8;
  constexpr double kUnknown = (std::numbers::sqrt2 + 0.5) * kSpacing;
  constexpr double kSampling = 0.4;  // mm: between the places of DistanceOf()
  const StandingStock stock(BoxShape(Vector3d::Zero(), kBlock), kSpacing);
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  int clear = 0, near = 0;
  for (int i = 0; i < 150; ++i) {
    const double radius = draw(2, 8);
    const CutterShape cutter{radius, i % 3 == 0 ? 0 : i % 3 == 1 ? radius : radius / 3, 25};
    const auto place = [&]() -> CutterPlace {
      return {{draw(-20, 80), draw(-20, 60), draw(10, 40)},
              Vector3d(draw(-0.5, 0.5), draw(-0.5, 0.5), 1).normalized()};
    };
    CutterMotion motion{place(), place(), 0};
    motion.to.tip = motion.from.tip + 0.3 * (motion.to.tip - motion.from.tip);
    motion.to.axis = (motion.from.axis + 0.3 * (motion.to.axis - motion.from.axis)).normalized();
    const double distance = DistanceOf(cutter, motion);
    const bool is_clear = AirCheck(cutter, kMargin, kSpacing).Of(motion, stock) == InAir::kClear;
    if (distance < kMargin) {
      ++near;
      EXPECT_FALSE(is_clear) << i << ": " << distance;
    } else if (distance > kMargin + 2 * kUnknown + kSampling) {
      ++clear;
      EXPECT_TRUE(is_clear) << i << ": " << distance;
    }
  }
  EXPECT_GT(clear, 15);
  EXPECT_GT(near, 15);
}

}  // namespace
}  // namespace millpose
