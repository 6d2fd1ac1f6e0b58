// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/shift.hpp"

#include <gtest/gtest.h>

#include <random>

namespace millpose {
namespace {

double LargestLeft(const Compensation::Along& d, double taken) {
  return std::max(std::abs(d.low - taken), std::abs(d.high - taken));
}

/// Whether some deflection of the interval is larger after than before.
bool Hurts(const Compensation::Along& d, double taken) {
  for (int i = 0; i <= 1000; ++i) {
    const double x = d.low + (d.high - d.low) * i / 1000;
    if (std::abs(x - taken) > std::abs(x) + 1e-12) return true;
  }
  return false;
}

TEST(TakenOut, LeavesTheLeastWorstOfAllAmountsThatCanHurtNothing) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int k = 0; k < 2000; ++k) {
    double a = any(random), b = any(random);
    if (a > b) std::swap(a, b);
    const Compensation::Along d{a, a + (b - a) * 0.5 * (1 + any(random)), b};
    const double taken = TakenOut(d, std::nullopt);
    EXPECT_FALSE(Hurts(d, taken)) << d.low << ' ' << d.expected << ' ' << d.high;
    EXPECT_LE(std::abs(taken), std::abs(d.expected) + 1e-15);
    // No other share of the expected that hurts nothing leaves less.
    for (int i = 0; i <= 400; ++i) {
      const double other = d.expected * i / 400;
      if (Hurts(d, other)) continue;
      EXPECT_GE(LargestLeft(d, other), LargestLeft(d, taken) - 1e-9);
    }
  }
}

TEST(TakenOut, IsAllOfWhatIsSureAndNothingOfWhatIsNot) {
  EXPECT_EQ(TakenOut({3, 3, 3}, std::nullopt), 3);
  EXPECT_EQ(TakenOut({-3, -3, -3}, std::nullopt), -3);
  EXPECT_EQ(TakenOut({-0.1, 2, 4}, std::nullopt), 0);
  EXPECT_EQ(TakenOut({-0.1, 2, 4}, 1), 2);
  EXPECT_EQ(TakenOut({1, 2, 4}, 0.25), 0.5);
  EXPECT_EQ(TakenOut({2, 3, 4}, std::nullopt), 3);
  EXPECT_EQ(TakenOut({0.5, 3, 4}, std::nullopt), 1);  // twice the least that is sure
  EXPECT_EQ(TakenOut({-4, -3, -0.5}, std::nullopt), -1);
}

TEST(LimitChange, NeverRaisesNeverChangesFasterAndKeepsWhatIsSlowEnough) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (const bool closed : {false, true})
    for (int k = 0; k < 300; ++k) {
      const size_t count = 2 + static_cast<size_t>(20 * any(random));
      std::vector<double> amounts, times;
      for (size_t i = 0; i < count; ++i) {
        amounts.push_back(any(random) < 0.2 ? 0 : 2 * any(random) - 1);
        times.push_back(0.01 + any(random));
      }
      const std::vector<double> before = amounts;
      constexpr double kSpeed = 0.3;
      LimitChange(amounts, times, kSpeed, closed);
      for (size_t i = 0; i < count; ++i) {
        EXPECT_LE(std::abs(amounts[i]), std::abs(before[i]) + 1e-15);
        EXPECT_GE(amounts[i] * before[i], 0);
        const size_t next = (i + 1) % count;
        if (next == 0 && !closed) continue;
        const bool turns = amounts[i] * amounts[next] < 0;  // down to zero and up again
        EXPECT_LE(std::abs(amounts[next] - amounts[i]), (turns ? 2 : 1) * kSpeed * times[i] + 1e-12);
      }
      std::vector<double> again = amounts;
      LimitChange(again, times, kSpeed, closed);
      for (size_t i = 0; i < count; ++i) EXPECT_NEAR(again[i], amounts[i], 1e-15);
    }
}

TEST(LimitChange, RampsDownToWhereNothingIsTakenOut) {
  std::vector<double> amounts = {0, 5, 5, 5, 0};
  LimitChange(amounts, std::vector<double>{1, 1, 1, 1}, 2, false);
  EXPECT_EQ(amounts, (std::vector<double>{0, 2, 4, 2, 0}));
  amounts = {5, 5, 0, 5};
  LimitChange(amounts, std::vector<double>{1, 1, 1, 1}, 2, true);
  EXPECT_EQ(amounts, (std::vector<double>{4, 2, 0, 2}));
}

}  // namespace
}  // namespace millpose
