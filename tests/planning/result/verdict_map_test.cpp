// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/verdict_map.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

TEST(VerdictMap, CellsReachHalfAStepToEitherSideRoundTheTurn) {
  EXPECT_EQ(AxisCellOf(-kPi).index, 0);
  EXPECT_EQ(AxisCellOf(kPi).index, 0);
  EXPECT_EQ(AxisCellOf(0).index, 60);
  EXPECT_EQ(AxisCellOf(DegToRad(1.4)).index, 60);
  EXPECT_EQ(AxisCellOf(DegToRad(1.6)).index, 61);
  EXPECT_NEAR(AxisCellOf(DegToRad(1.4)).off, DegToRad(1.4), 1e-12);
  EXPECT_EQ(AxisCellOf(DegToRad(179)).index, 0);
  EXPECT_EQ(AxisCellOf(DegToRad(-359)).index, 60);
  EXPECT_EQ(AxisCellOf(DegToRad(540)).index, 0);
}

TEST(VerdictMap, RunsReadBack) {
  AxisVerdicts verdicts(8 * kAxisRotations, kVerdictUnknown);
  EXPECT_TRUE(PackVerdicts(verdicts).empty());
  for (int i = 0; i < 5; ++i) verdicts[static_cast<size_t>(130 + i)] = kVerdictPair + 7;
  verdicts[135] = verdicts.back() = kVerdictFree;
  EXPECT_EQ(PackVerdicts(verdicts), (std::vector<int>{0, 130, 9, 5, 1, 1, 0, 823, 1, 1}));
  EXPECT_EQ(UnpackVerdicts(PackVerdicts(verdicts)), verdicts);
}

TEST(VerdictMap, DamagedRunsGiveNoMoreThanThereIs) {
  EXPECT_EQ(UnpackVerdicts({1, 1 << 30}).size(), 8u * kAxisRotations);
  EXPECT_EQ(UnpackVerdicts({1, -4, 2}), AxisVerdicts(8 * kAxisRotations, kVerdictUnknown));
}

}  // namespace
}  // namespace millpose
