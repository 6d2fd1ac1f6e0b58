// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/lost_motion_fit.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/stiffness/compliance.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kArcmin = kRadPerDeg / 60;

Arm StiffArm() {
  Arm arm = test::SampleArm();
  arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;
  return arm;
}

TwoWayReading Approached(const Arm& arm, int joint, double width, size_t count, double noise,
                         RandomStream& random) {
  TwoWayReading reading;
  reading.joint = joint;
  reading.q = test::Degrees(10, -70, 95, 20, 50, -30);
  for (int i = 0; i < 6; ++i) reading.q[i] += random.Uniform(-0.3, 0.3);
  reading.point = Vector3d(-250, 30, 250);
  reading.direction = Jacobian(arm, reading.q, reading.point).col(joint).head<3>().normalized();
  if (random.Below(2) == 0) reading.direction = -reading.direction;
  const double lever = reading.direction.dot(Jacobian(arm, reading.q, reading.point).col(joint).head<3>());
  for (size_t k = 0; k < count; ++k) {
    reading.first.push_back(0.4 - 0.5 * width * lever + noise * random.Normal());
    reading.second.push_back(0.4 + 0.5 * width * lever + noise * random.Normal());
  }
  return reading;
}

TEST(FitLostMotion, HalfTheDifferenceOfTheTwoWays) {
  const Arm arm = StiffArm();
  RandomStream random(1, 0);
  std::vector<TwoWayReading> readings;
  for (int joint = 0; joint < 5; ++joint)
    readings.push_back(Approached(arm, joint, (joint + 1) * 0.2 * kArcmin, 3, 0, random));
  const auto found = FitLostMotion(arm, readings);
  for (int joint = 0; joint < 5; ++joint) {
    const LostMotionEstimate& of = found[static_cast<size_t>(joint)];
    ASSERT_TRUE(of.determined) << of.reason;
    EXPECT_NEAR(of.width, (joint + 1) * 0.2 * kArcmin, 1e-12);
    EXPECT_NEAR(of.upper - of.lower, 0, 1e-12);
  }
  EXPECT_EQ(found[5].reason, "not measured");
}

TEST(FitLostMotion, IntervalsHoldTheTruthInNineteenOfTwenty) {
  const Arm arm = StiffArm();
  RandomStream random(2, 0);
  const double width = 0.5 * kArcmin;
  for (const auto& [poses, count] : {std::pair<int, size_t>{1, 5}, {3, 3}}) {
    int held = 0;
    for (int run = 0; run < 2000; ++run) {
      std::vector<TwoWayReading> readings;
      for (int p = 0; p < poses; ++p) readings.push_back(Approached(arm, 2, width, count, 0.003, random));
      const LostMotionEstimate of = FitLostMotion(arm, readings)[2];
      ASSERT_TRUE(of.determined);
      held += of.lower <= width && width <= of.upper;
    }
    EXPECT_NEAR(held / 2000.0, 0.95, 0.015) << poses;
  }
}

// With a force to either side what the arm yields is in the readings too.
TEST(FitLostMotion, PushedReadingsLoseWhatTheArmYields) {
  const Arm arm = StiffArm();
  RandomStream random(3, 0);
  for (int trial = 0; trial < 10; ++trial) {
    const double width = 0.4 * kArcmin;
    TwoWayReading reading = Approached(arm, 1, width, 3, 0, random);
    reading.push = 300;
    const Matrix6 J = Jacobian(arm, reading.q, reading.point);
    const double give =
        reading.push *
        reading.direction.dot(Compliance(J, arm.stiffness).topLeftCorner<3, 3>() * reading.direction);
    const double step = 0.5 * width * std::abs(reading.direction.dot(J.col(1).head<3>()));
    reading.first.assign(3, -step - give);
    reading.second.assign(3, step + give);
    const LostMotionEstimate of = FitLostMotion(arm, {reading})[1];
    ASSERT_TRUE(of.determined) << of.reason;
    EXPECT_NEAR(of.width, width, 1e-12);
  }
}

TEST(FitLostMotion, SaysWhyThereIsNoNumber) {
  const Arm arm = StiffArm();
  RandomStream random(4, 0);
  TwoWayReading few = Approached(arm, 0, kArcmin, 2, 0.001, random);
  EXPECT_TRUE(FitLostMotion(arm, {few})[0].reason.starts_with("too few readings"));
  TwoWayReading across = Approached(arm, 3, kArcmin, 5, 0.001, random);
  across.direction = across.direction.unitOrthogonal();
  EXPECT_EQ(FitLostMotion(arm, {across})[3].reason, "its turning does not move the dial");
  TwoWayReading exchanged = Approached(arm, 4, kArcmin, 5, 0.001, random);
  std::swap(exchanged.first, exchanged.second);
  EXPECT_TRUE(FitLostMotion(arm, {exchanged})[4].reason.starts_with("the differences have the wrong sign"));
  // A joint that weight holds shows nothing: 0 with its interval, not a negative number.
  const LostMotionEstimate held = FitLostMotion(arm, {Approached(arm, 1, 0, 5, 0.001, random)})[1];
  EXPECT_TRUE(held.determined);
  EXPECT_GE(held.lower, 0);
  EXPECT_LT(held.width, 0.1 * kArcmin);
}

}  // namespace
}  // namespace millpose
