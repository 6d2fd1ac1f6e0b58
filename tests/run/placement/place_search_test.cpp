// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace millpose {
namespace {

/// Waves on a bowl: many places are better than all near them, one is the best.
double Waves(std::span<const double> shares) {
  double value = 0;
  for (size_t i = 0; i < shares.size(); ++i) {
    const double x = 4 * (shares[i] - 0.3 - 0.1 * static_cast<double>(i));
    value += x * x + 0.4 * (1 - std::cos(9 * x));
  }
  return value;
}

std::vector<std::vector<double>> Asked(size_t dimensions, int evaluations, uint64_t seed) {
  std::vector<std::vector<double>> asked;
  SearchShares(std::vector<double>(dimensions, 0.5), evaluations, seed, [&](std::span<const double> shares) {
    asked.emplace_back(shares.begin(), shares.end());
    return Waves(shares);
  });
  return asked;
}

TEST(SearchShares, FindsTheBestOfManyValleys) {
  for (const size_t dimensions : {1, 2, 3, 6}) {
    double least = 1e9;
    for (const auto& shares : Asked(dimensions, 2000, 1)) least = std::min(least, Waves(shares));
    EXPECT_LT(least, dimensions < 6 ? 1e-3 : 1) << dimensions;
  }
}

TEST(SearchShares, KeepsItsBoundsAndItsBudget) {
  for (const int evaluations : {1, 2, 7, 300}) {
    const auto asked = Asked(2, evaluations, 1);
    EXPECT_LE(asked.size(), static_cast<size_t>(evaluations));
    EXPECT_FALSE(asked.empty());
    for (const auto& shares : asked)
      for (const double share : shares) {
        EXPECT_GE(share, 0);
        EXPECT_LE(share, 1);
      }
  }
}

TEST(SearchShares, AsksTheSameForASeed) {
  EXPECT_EQ(Asked(3, 400, 5), Asked(3, 400, 5));
  EXPECT_NE(Asked(3, 400, 5), Asked(3, 400, 6));
}

TEST(SearchShares, PassesOnWhatIsThrown) {
  int count = 0;
  EXPECT_THROW(SearchShares({0.5, 0.5}, 500, 1,
                            [&](std::span<const double>) {
                              if (++count == 60) throw std::runtime_error("stop");
                              return static_cast<double>(count);
                            }),
               std::runtime_error);
  EXPECT_EQ(count, 60);
}

}  // namespace
}  // namespace millpose
