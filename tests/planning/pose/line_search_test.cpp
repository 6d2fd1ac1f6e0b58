// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/line_search.hpp"

#include <functional>

#include "base/units.hpp"

namespace millpose {
namespace {

struct Outcome {
  double place, value;
  int evaluations;
};
Outcome Search(const std::function<double(double)>& f, double start, double tolerance = 1e-7,
               double end_tolerance = 1e-13) {
  LineSearch search(start, f(start), 0.01, 3, tolerance, end_tolerance);
  int evaluations = 0;
  while (!search.done() && evaluations < 1000) {
    search.Tell(f(search.Ask()));
    ++evaluations;
  }
  EXPECT_TRUE(search.done());
  EXPECT_EQ(search.best_value(), f(search.best()));
  return {search.best(), search.best_value(), evaluations};
}

TEST(LineSearch, FindsAMinimumInside) {
  for (const double start : {-2.0, -0.703, 0.699, 0.7, 1.5}) {
    const Outcome found = Search([](double x) { return 3 + (x - 0.7) * (x - 0.7); }, start);
    EXPECT_NEAR(found.place, 0.7, 1e-6) << start;
    EXPECT_LT(found.evaluations, 60);
  }
}

TEST(LineSearch, EndsExactlyOnTheEndOfTheInterval) {
  for (const double slope : {-1.0, 1.0}) {
    for (const double start : {-1.0, 0.0, 0.9, -1.2, 1.23455}) {
      const auto f = [&](double x) { return x < -1.23456 || x > 1.23456 ? kInfinity : 5 + slope * x; };
      const Outcome found = Search(f, start);
      EXPECT_NEAR(found.place, slope > 0 ? -1.23456 : 1.23456, 1e-12) << start;
      EXPECT_LE(std::abs(found.place), 1.23456);
    }
  }
}

TEST(LineSearch, MinimumJustInsideTheEnd) {
  const auto f = [](double x) { return x > 0.5 ? kInfinity : 1 + (x - 0.499) * (x - 0.499); };
  EXPECT_NEAR(Search(f, 0).place, 0.499, 1e-6);
  EXPECT_NEAR(Search(f, 0.4999).place, 0.499, 1e-6);
}

TEST(LineSearch, StopsAtItsReach) {
  LineSearch search(0, 0, 0.01, 1, 1e-6, 1e-9);
  double farthest = 0;
  for (int k = 0; k < 1000 && !search.done(); ++k) {
    farthest = std::max(farthest, std::abs(search.Ask()));
    search.Tell(-search.Ask());
  }
  EXPECT_TRUE(search.done());
  EXPECT_LT(farthest, 4);
  EXPECT_GE(search.best(), 1);
}

TEST(LineSearch, SinglePlaceIsItsOwnMinimum) {
  const Outcome found = Search([](double x) { return x == 0.25 ? 1 : kInfinity; }, 0.25);
  EXPECT_EQ(found.place, 0.25);
  EXPECT_EQ(found.value, 1);
}

}  // namespace
}  // namespace millpose
