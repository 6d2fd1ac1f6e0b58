// SPDX-License-Identifier: GPL-3.0-or-later
// The judge's counter of reversals by known answers, and beside the planner's.
#include "tests/audit/reversals.hpp"

#include <gtest/gtest.h>

#include <map>

#include "base/random.hpp"
#include "machine/motion/lost_motion.hpp"

namespace millpose::audit {
namespace {

TEST(Reversals, KnownAnswers) {
  EXPECT_TRUE(TurningPlaces({}, 1).empty());
  EXPECT_TRUE(TurningPlaces({3}, 1).empty());
  EXPECT_EQ(TurningPlaces({0, 4, 0}, 1), std::vector<size_t>({1}));
  EXPECT_EQ(TurningPlaces({0, 4, 4, 0}, 1), std::vector<size_t>({1}));
  EXPECT_TRUE(TurningPlaces({0, 4, 3.5L, 8}, 1).empty());
  EXPECT_TRUE(TurningPlaces({0, -0.9L, 8, 7.1L}, 1).empty()) << "the ends";
  EXPECT_EQ(TurningPlaces({0, 4, 3.5L, 4.2L, 0}, 1), std::vector<size_t>({3}));
  const std::vector<Real> lag = Lag({0, 1, 0.9L, 0, 1}, 0.2L, 0.05L), expected{-0.1L, -0.1L, 0, 0.1L, -0.1L};
  for (size_t t = 0; t < lag.size(); ++t)
    EXPECT_NEAR(static_cast<double>(lag[t]), static_cast<double>(expected[t]), 1e-15) << t;
}

TEST(Reversals, AreThoseOfThePlanner) {
  RandomStream random(41, 0);
  size_t turns = 0;
  for (int trial = 0; trial < 300; ++trial) {
    LostMotion lost;
    lost.dead_zone.setConstant(random.Uniform(0, 2));
    lost.width.setConstant(random.Uniform(0, 3));
    std::vector<GearPlace> way(static_cast<size_t>(random.Below(80)));
    std::vector<Real> plain;
    double at = 0, slope = 0;
    for (GearPlace& place : way) {
      if (random.Below(8) == 0) slope = random.Uniform(-1, 1);
      at += slope + random.Uniform(-0.5, 0.5);
      place.at[3] = at;
      plain.push_back(at);
    }
    std::vector<size_t> planners;
    for (const GearEvent& event : GearEvents(lost, way)) {
      EXPECT_EQ(event.gear, 3);
      planners.push_back(event.place);
    }
    EXPECT_EQ(planners, TurningPlaces(plain, lost.dead_zone[3])) << trial;
    turns += planners.size();
    const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
    const std::vector<Real> lag = Lag(plain, lost.width[3], lost.dead_zone[3]);
    for (size_t t = 0; t < way.size(); ++t)
      ASSERT_NEAR(offsets[t][3], static_cast<double>(lag[t]), 1e-12) << trial << ' ' << t;
  }
  EXPECT_GT(turns, 500u);
}

}  // namespace
}  // namespace millpose::audit
