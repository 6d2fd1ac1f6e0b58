// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/trig.hpp"

#include "base/random.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

/// |value − exact| in units in the last place of `exact` as a double (of 2⁻⁵³ below, near 0).
double Ulps(double value, long double exact) {
  const double rounded = static_cast<double>(exact);
  const double unit = std::max(std::nextafter(std::abs(rounded), 10.0) - std::abs(rounded), 1e-300);
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
  for (int k = 0; k < 300000; ++k) {
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
  for (int k = 0; k < 500000; ++k) {
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
