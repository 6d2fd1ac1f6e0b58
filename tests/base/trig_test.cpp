// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/trig.hpp"

#include <Eigen/Geometry>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

/// |value − exact| in units in the last place of `exact` as a double.
double Ulps(double value, long double exact) {
  const double rounded = static_cast<double>(exact);
  const double unit = std::max(std::nextafter(std::abs(rounded), 1e308) - std::abs(rounded), 1e-300);
  return static_cast<double>(std::fabs(value - exact) / unit);
}

TEST(Trig, SineAndCosineAreRightToOneUlp) {
  RandomStream stream(1, 0);
  double worst = 0;
  const auto check = [&](double x) {
    const SineCosine own = SinCos(x);
    const long double exact = x;
    worst = std::max({worst, Ulps(own.sin, sinl(exact)), Ulps(own.cos, cosl(exact))});
  };
  for (int k = 0; k < 60000; ++k) {
    check(stream.Uniform(-10, 10));
    check(stream.Uniform(-1e5, 1e5));
    check(stream.Uniform(-1e-3, 1e-3));
    check((stream.Below(400) - 200) * kPi / 4 + stream.Uniform(-1e-6, 1e-6));
  }
  EXPECT_LT(worst, 1.0);
}

TEST(Trig, SineAndCosineAtMultiplesOfHalfPi) {
  for (int k = -100000; k <= 100000; k += 7) {
    const double x = k * (kPi / 2);
    if (std::abs(x) > 1e5) continue;
    const SineCosine own = SinCos(x);
    // Near a zero the reduction decides; all of its digits must hold against the C library's exact one.
    EXPECT_NEAR(own.sin, std::sin(x), 2e-16 * std::max(std::abs(std::sin(x)), 1e-12)) << k;
    EXPECT_NEAR(own.cos, std::cos(x), 2e-16 * std::max(std::abs(std::cos(x)), 1e-12)) << k;
  }
  EXPECT_EQ(SinCos(0.0).sin, 0.0);
  EXPECT_EQ(SinCos(0.0).cos, 1.0);
  EXPECT_EQ(SinCos(kPi / 2).sin, 1.0);
}

TEST(Trig, ArcTangentIsRightToTwoUlps) {
  RandomStream stream(2, 0);
  double worst = 0;
  for (int k = 0; k < 100000; ++k) {
    const double angle = stream.Uniform(-kPi, kPi), size = std::exp(stream.Uniform(-20, 20));
    const double x = size * std::cos(angle), y = size * std::sin(angle);
    worst = std::max(worst, Ulps(Atan2(y, x), atan2l(y, x)));
    const double tiny = stream.Uniform(-1e-9, 1e-9);
    worst = std::max(worst, Ulps(Atan2(tiny, 1), atan2l(tiny, 1)));
    worst = std::max(worst, Ulps(Atan2(1, tiny), atan2l(1, tiny)));
  }
  EXPECT_LT(worst, 2.0);
}

TEST(Trig, ArcTangentOnTheAxes) {
  EXPECT_EQ(Atan2(0, 0), 0.0);
  EXPECT_EQ(Atan2(0, 5), 0.0);
  EXPECT_EQ(Atan2(0, -5), kPi);
  EXPECT_EQ(Atan2(-0.0, -5), -kPi);
  EXPECT_EQ(Atan2(5, 0), kPi / 2);
  EXPECT_EQ(Atan2(-5, 0), -kPi / 2);
  EXPECT_EQ(Atan2(3, 3), kPi / 4);
  EXPECT_EQ(Atan2(-3, -3), -3 * kPi / 4);
}

TEST(Trig, ArcSineAndCosineAreRightToThreeUlps) {
  RandomStream stream(4, 0);
  double worst = 0;
  const auto check = [&](double x) {
    worst = std::max({worst, Ulps(Asin(x), asinl(x)), Ulps(Acos(x), acosl(x))});
  };
  for (int k = 0; k < 50000; ++k) {
    check(stream.Uniform(-1, 1));
    check(1 - std::exp(stream.Uniform(-36, 0)));
    check(std::exp(stream.Uniform(-36, 0)) - 1);
    check(stream.Uniform(-1e-9, 1e-9));
  }
  EXPECT_LT(worst, 3.0);
  EXPECT_EQ(Asin(1), kPi / 2);
  EXPECT_EQ(Acos(1), 0);
  EXPECT_EQ(Acos(-1), kPi);
}

TEST(Trig, HypotenuseLogarithmAndExponentialAreRightToOneUlp) {
  RandomStream stream(5, 0);
  double hypotenuse = 0, logarithm = 0, exponential = 0;
  const auto log_at = [&](double x) { logarithm = std::max(logarithm, Ulps(Log(x), logl(x))); };
  for (int k = 0; k < 50000; ++k) {
    const double x = stream.Uniform(-1e3, 1e3), y = x * std::exp(stream.Uniform(-40, 40));
    hypotenuse = std::max(hypotenuse, Ulps(Hypot(x, y), hypotl(x, y)));
    log_at(std::exp(stream.Uniform(-700, 700)));
    log_at(stream.Uniform(0.5, 2));
    log_at(1 + stream.Uniform(-1e-6, 1e-6));
    for (const double e : {stream.Uniform(-700, 700), stream.Uniform(-2, 2), stream.Uniform(-1e-9, 1e-9)})
      exponential = std::max(exponential, Ulps(Exp(e), expl(e)));
  }
  EXPECT_LT(hypotenuse, 1.5);
  EXPECT_LT(logarithm, 1.0);
  EXPECT_LT(exponential, 1.0);
  EXPECT_EQ(Log(1), 0);
  EXPECT_EQ(Exp(0), 1);
}

TEST(Trig, PowersAreRightWithinTheirBound) {
  RandomStream stream(6, 0);
  double worst = 0;
  for (int k = 0; k < 50000; ++k) {
    const double x = std::exp(stream.Uniform(-20, 20)), y = stream.Uniform(-30, 30);
    worst = std::max(worst, Ulps(Pow(x, y), powl(x, y)) / (2 + 2 * std::abs(y * std::log(x))));
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_EQ(Pow(1, 5), 1);
  EXPECT_EQ(Pow(7, 0), 1);
}

TEST(Trig, RotationsTurnAsAngleAxisDoes) {
  RandomStream stream(7, 0);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d axis =
        Eigen::Vector3d(stream.Uniform(-1, 1), stream.Uniform(-1, 1), stream.Uniform(0.1, 1)).normalized();
    const double angle = stream.Uniform(-7, 7);
    EXPECT_LT((RotationAbout(axis, angle) - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 4e-15);
  }
}

TEST(Trig, LoopOverLanesGivesTheSameBits) {
  RandomStream stream(3, 0);
  std::array<double, 64> x, y, s, c, a;
  for (int round = 0; round < 1000; ++round) {
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] = stream.Uniform(-400, 400);
      y[i] = stream.Uniform(-400, 400);
    }
    for (size_t i = 0; i < x.size(); ++i) {
      const SineCosine both = SinCos(x[i]);
      s[i] = both.sin;
      c[i] = both.cos;
      a[i] = Atan2(y[i], x[i]);
    }
    for (size_t i = 0; i < x.size(); ++i) {
      volatile double xi = x[i], yi = y[i];  // keeps the compiler from vectorising this one
      const SineCosine both = SinCos(xi);
      ASSERT_EQ(both.sin, s[i]);
      ASSERT_EQ(both.cos, c[i]);
      ASSERT_EQ(Atan2(yi, xi), a[i]);
    }
  }
}

}  // namespace
}  // namespace millpose
