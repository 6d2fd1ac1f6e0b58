// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/time_law.hpp"

#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

TEST(TimeLaw, KeepsEverySpeedAndAccelerationAndOneIsUsedFully) {
  const Arm arm = SampleArm();
  RandomStream random(4, 0);
  for (int trial = 0; trial < 100; ++trial) {
    Joints delta;
    const double size = trial % 2 ? 0.02 : 2.0;
    for (int i = 0; i < 6; ++i) delta[i] = random.Uniform(-size, size);
    const TimeLaw law = FastestLaw(delta, arm.speed, arm.acceleration);
    EXPECT_EQ(law.Share(0), 0);
    EXPECT_EQ(law.Share(law.duration), 1);
    const double dt = law.duration / 2000;
    double fullest_speed = 0, fullest_acceleration = 0;
    for (int k = 1; k < 2000; ++k) {
      const double before = law.Share((k - 1) * dt), at = law.Share(k * dt), after = law.Share((k + 1) * dt);
      EXPECT_GE(after, at);
      const double v = (after - before) / (2 * dt), a = (after - 2 * at + before) / (dt * dt);
      for (int i = 0; i < 6; ++i) {
        fullest_speed = std::max(fullest_speed, std::abs(v * delta[i]) / arm.speed[i]);
        fullest_acceleration = std::max(fullest_acceleration, std::abs(a * delta[i]) / arm.acceleration[i]);
      }
    }
    EXPECT_LE(fullest_speed, 1 + 1e-6);
    EXPECT_LE(fullest_acceleration, 1 + 1e-3);
    EXPECT_GT(fullest_acceleration, 0.99);
  }
}

TEST(TimeLaw, KnownDurations) {
  Joints delta = Joints::Zero();
  EXPECT_EQ(FastestLaw(delta, Joints::Ones(), Joints::Ones()).duration, 0);
  delta[2] = -3;
  // 1 rad/s, 2 rad/s²: half a second up, 2.5 s even, half a second down.
  EXPECT_DOUBLE_EQ(FastestLaw(delta, Joints::Ones(), Joints::Constant(2)).duration, 3.5);
  delta[2] = 0.125;
  EXPECT_DOUBLE_EQ(FastestLaw(delta, Joints::Ones(), Joints::Constant(2)).duration, 0.5);
  const std::vector<Joints> corners{Joints::Zero(), delta, Joints::Zero()};
  EXPECT_DOUBLE_EQ(PathDuration(corners, Joints::Ones(), Joints::Constant(2)), 1.0);
}

TEST(FeedLaw, GoesTheWholeWayWithinItsSpeedAndAcceleration) {
  for (const double ramp : {0.0, 0.3, 1.0, 9.0}) {
    for (const bool from : {false, true}) {
      for (const bool to : {false, true}) {
        const TimeLaw law = FeedLaw(2, ramp, from, to);
        EXPECT_GE(law.duration, 2 - 1e-12);
        double way = 0;
        const int steps = 20000;
        for (int i = 0; i < steps; ++i) {
          const double time = law.duration * (i + 0.5) / steps;
          const double rate = law.Rate(time);
          EXPECT_LE(rate, 0.5 + 1e-12);
          way += rate * law.duration / steps;
          if (i % 1000 == 0) {
            ASSERT_NEAR(law.Share(time), way, 1e-4) << ramp << from << to;
          }
        }
        EXPECT_NEAR(way, 1, 1e-4);
        EXPECT_EQ(law.Share(law.duration), 1);
        EXPECT_NEAR(law.Rate(law.duration), ramp > 0 && to ? 0 : law.speed, 1e-12);
        EXPECT_NEAR(law.Rate(0), ramp > 0 && from ? 0 : law.speed, 1e-12);
        if (ramp == 0 || (!from && !to)) {
          EXPECT_EQ(law.duration, 2);
        }
      }
    }
  }
  EXPECT_DOUBLE_EQ(FeedLaw(2, 0.5, true, true).duration, 2.5);
}

}  // namespace
}  // namespace millpose::test
