// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/fisher.hpp"

#include "base/random.hpp"

namespace millpose {
namespace {

TEST(Fisher, GammaOfWholeAndHalfNumbers) {
  double whole = 1, half = std::sqrt(3.14159265358979323846);
  for (int n = 1; n < 60; ++n) {
    EXPECT_NEAR(LogGamma(n), std::log(whole), 1e-13 * std::max(1.0, std::log(whole)));
    EXPECT_NEAR(LogGamma(n - 0.5), std::log(half), 1e-13 * std::max(1.0, std::abs(std::log(half))));
    whole *= n;
    half *= n - 0.5;
  }
}

// Of two degrees of freedom, above or below, the tail has a closed form; a third law joins both ends.
TEST(Fisher, TailsHaveTheirClosedForms) {
  for (const double f : {0.01, 0.3, 1.0, 2.5, 9.0, 80.0})
    for (const double m : {1.0, 2.0, 5.0, 17.0, 46.0, 100000.0}) {
      const double two = std::pow(m / (m + 2 * f), m / 2);
      EXPECT_NEAR(FisherTail(f, 2, m), two, 1e-10 * std::max(two, 1e-10)) << f << ' ' << m;
      for (const double n : {3.0, 4.0, 6.0})
        EXPECT_NEAR(FisherTail(f, n, m) + FisherTail(1 / f, m, n), 1, 1e-9) << f << ' ' << n << ' ' << m;
    }
}

// 1 % points of printed tables (Abramowitz and Stegun, table 26.9).
TEST(Fisher, QuantilesOfTables) {
  for (const auto& [f, n, m] : {std::tuple(5.417, 3, 15),
                                {4.938, 3, 20},
                                {4.510, 3, 30},
                                {4.126, 3, 60},
                                {4.431, 4, 20},
                                {3.699, 5, 30},
                                {3.119, 6, 60},
                                {2.956, 6, 120}})
    EXPECT_NEAR(FisherTail(f, n, m), 0.01, 1e-5) << n << ' ' << m;
}

// Quotients of drawn squares lie above as often as said.
TEST(Fisher, DrawnQuotientsLieAboveAsOften) {
  RandomStream random(43, 1);
  constexpr int kDraws = 20000;
  const auto mean_square = [&](int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double x = random.Normal();
      sum += x * x;
    }
    return sum / n;
  };
  int above = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double numerator = mean_square(3);
    above += FisherTail(numerator / mean_square(11), 3, 11) < 0.1 ? 1 : 0;
  }
  EXPECT_NEAR(above, 0.1 * kDraws, 4 * std::sqrt(0.09 * kDraws));
}

}  // namespace
}  // namespace millpose
