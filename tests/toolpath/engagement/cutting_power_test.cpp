// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/cutting_power.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"

namespace millpose {
namespace {

EdgeModel EdgeOfPower(double mc) {
  EdgeModel edge;
  edge.material = {"steel", 1800, mc, ""};
  edge.cutter = {10, 0, 40};
  edge.teeth = 3;
  return edge;
}

Engagement CutOf(CutSide side, double width, double depth) {
  Engagement cut;
  cut.side = side, cut.width = width, cut.depth = depth;
  return cut;
}

// Without an exponent it is the specific force times the volume cut per second, whatever width and speed.
TEST(CuttingPower, IsTheSpecificForceTimesTheVolumePerSecond) {
  for (const double width : {0.1, 3.0, 10.0, 17.0, 20.0})
    for (const double speed : {20.0, 110.0}) {
      const double volume = width * 2.5 * 12;  // mm³/s
      EXPECT_NEAR(CuttingPower(EdgeOfPower(0), CutOf(CutSide::kDown, width, 2.5), 12, speed),
                  1800 * volume / 1e3, 1e-3 * 1.8 * volume);
    }
  const EdgeModel edge = EdgeOfPower(0);
  EXPECT_NEAR(CuttingPower(edge, CutOf(CutSide::kSlot, 0, 2.5), 12, 60), 1.8 * 20 * 2.5 * 12, 2);
}

// Thin chips cost more: with an exponent the power goes with the feed to the power of 1 − m_c.
TEST(CuttingPower, FollowsKienzlesExponent) {
  const EdgeModel edge = EdgeOfPower(0.25);
  const Engagement cut = CutOf(CutSide::kUp, 6, 4);
  const double once = CuttingPower(edge, cut, 10, 100);
  EXPECT_NEAR(CuttingPower(edge, cut, 20, 100), once * std::pow(2, 0.75), 1e-6 * once);
  EXPECT_NEAR(CuttingPower(edge, CutOf(CutSide::kDown, 6, 4), 10, 100), once, 1e-9 * once);
  EXPECT_EQ(CuttingPower(edge, CutOf(CutSide::kAir, 6, 4), 10, 100), 0);
}

}  // namespace
}  // namespace millpose
