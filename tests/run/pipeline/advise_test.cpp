// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/advise.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace millpose {
namespace {

struct AdvisedLoad {
  std::string name;
  std::function<std::optional<CutLoad>(double)> load;
};

// Loads that grow as they like: with the value, slower, faster, in steps, from a level on, up to a refusal.
std::vector<AdvisedLoad> Loads() {
  return {{"linear",
           [](double v) {
             return CutLoad{0.02 * v, 0};
           }},
          {"root",
           [](double v) {
             return CutLoad{0.05 * std::sqrt(v), 0};
           }},
          {"slow",
           [](double v) {
             return CutLoad{0.08 * std::pow(v, 0.15), 0};
           }},
          {"cubic",
           [](double v) {
             return CutLoad{0.002 * v * v * v, 0};
           }},
          {"steps",
           [](double v) {
             return CutLoad{0.03 * std::ceil(v / 1.7), 0};
           }},
          {"level",
           [](double v) {
             return CutLoad{0.05 + 0.001 * v, 0};
           }},
          {"power",
           [](double v) {
             return CutLoad{0.001 * v, 40 * v};
           }},
          {"refused", [](double v) {
             return v > 3.3 ? std::nullopt : std::optional(CutLoad{0.01 * v, 0});
           }}};
}

// Whatever it starts from: the value keeps the limits, 5 % more does not, and it takes few looks.
TEST(Advise, IsTheLargestWithinTheLimits) {
  const AdviseLimits limits{0.1, 300.0};
  constexpr double kLargestValue = 60, kGrain = 0.001;
  for (const AdvisedLoad& given : Loads())
    for (const double start : {0.2, 1.0, 4.9, 30.0}) {
      SCOPED_TRACE(given.name + std::to_string(start));
      int looks = 0;
      const auto counted = [&](double value) {
        ++looks;
        EXPECT_LE(value, kLargestValue);
        return given.load(value);
      };
      const auto keeps = [&](double value) {
        const auto load = given.load(value);
        return load && load->error <= limits.error && load->power <= *limits.power;
      };
      const Advice advice = LargestWithin(limits, {start, 0.01, kLargestValue, kGrain}, counted);
      ASSERT_NE(advice.bound, AdviceBound::kSmallest);
      EXPECT_TRUE(keeps(advice.value)) << advice.value;
      EXPECT_NEAR(advice.load.error, given.load(advice.value)->error, 1e-12);
      if (advice.bound == AdviceBound::kLargest)
        EXPECT_NEAR(advice.value, kLargestValue, kGrain);
      else
        EXPECT_FALSE(keeps(1.05 * advice.value)) << advice.value;
      EXPECT_EQ(advice.bound == AdviceBound::kPower, given.name == "power");
      EXPECT_EQ(advice.bound == AdviceBound::kRefused, given.name == "refused");
      EXPECT_LE(looks, 30);
    }
}

TEST(Advise, SaysWhereNoValueKeepsTheLimits) {
  const AdviseLimits limits{0.1, {}};
  const Advice advice = LargestWithin(limits, {2, 0.5, 60, 0.001}, [](double value) {
    EXPECT_GE(value, 0.5 - 1e-9);
    return std::optional(CutLoad{0.11, 0});
  });
  EXPECT_EQ(advice.bound, AdviceBound::kSmallest);
  EXPECT_EQ(advice.value, 0);
  EXPECT_NEAR(advice.beyond, 0.5, 1e-9);
}

}  // namespace
}  // namespace millpose
