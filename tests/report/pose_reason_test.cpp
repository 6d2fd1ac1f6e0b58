// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/pose_reason.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"

namespace millpose {
namespace {

PoseAt At(double degrees, int branch, double objective) { return {DegToRad(degrees), branch, objective}; }

/// A point that has its own optimum.
PoseReason Best() {
  PoseReason reason;
  reason.unit = "µm";
  reason.path = reason.free = reason.own = At(-157, 2, 12.1);
  reason.unsmoothed = 12.1;
  return reason;
}

using Sentences = std::vector<std::string>;

TEST(PoseReason, TheOptimumItself) {
  EXPECT_EQ(ReasonSentences(Best()),
            (Sentences{"the path has -157 deg (S2, 12.1 µm)", "that is the point's own optimum"}));
}

TEST(PoseReason, Skipped) {
  PoseReason reason = Best();
  reason.skipped = "interference: link4 and workpiece touch";
  EXPECT_EQ(ReasonSentences(reason), Sentences{"skipped: interference: link4 and workpiece touch"});
}

TEST(PoseReason, TheOptimumIsBeyondATouch) {
  PoseReason reason = Best();
  reason.own = At(-169, 2, 10);
  reason.barred = "link4_fork and workpiece";
  reason.beyond = DegToRad(12);
  EXPECT_EQ(
      ReasonSentences(reason),
      (Sentences{"the path has -157 deg (S2, 12.1 µm)",
                 "the optimum at -169 deg (S2, 10 µm) is 12 deg beyond where link4_fork and workpiece come "
                 "too near",
                 "the path has the best free pose"}));
  reason.beyond = 0;
  EXPECT_EQ(ReasonSentences(reason)[1],
            "the optimum at -169 deg (S2, 10 µm) is blocked: link4_fork and workpiece come too near, and no "
            "rotation "
            "on its branch is known to be free");
}

TEST(PoseReason, ThePassWouldHaveToTurnBack) {
  PoseReason reason = Best();
  reason.own = reason.free = At(123, 2, 10);
  reason.stretch = {30, false, "then axis 4 is beyond its limit"};
  EXPECT_EQ(
      ReasonSentences(reason),
      (Sentences{
          "the path has -157 deg (S2, 12.1 µm)", "the optimum at 123 deg (S2, 10 µm) is free of interference",
          "the best free pose at 123 deg (S2, 10 µm) can be followed for 30 mm only (then axis 4 is beyond "
          "its limit): the cut would have to turn by 80 deg and back within that"}));
  reason.stretch = {900, true, {}};
  EXPECT_EQ(ReasonSentences(reason)[2],
            "the best free pose at 123 deg (S2, 10 µm) is 80 deg away: it can be followed along the whole "
            "cut, but the "
            "cut as a whole is better as planned");
  reason.free.branch = 3;
  EXPECT_EQ(
      ReasonSentences(reason)[2],
      "the best free pose at 123 deg (S3, 10 µm) is on branch S3, the cut runs on S2 and cannot change");
}

TEST(PoseReason, WhatTheBoundsForbid) {
  PoseReason reason = Best();
  reason.forbidden = ForbiddenPose{At(20, 6, 9), 3, DegToRad(7.2)};
  EXPECT_EQ(ReasonSentences(reason)[1],
            "stiffer without limits: 20 deg (S6, 9 µm), but axis 4 is 8 deg beyond its limit there");
  reason.forbidden->joint = -1;
  EXPECT_EQ(ReasonSentences(reason)[1], "stiffer without limits: 20 deg (S6, 9 µm), but that is singular");
  reason.forbidden->pose.objective = 12;  // hardly
  EXPECT_EQ(ReasonSentences(reason).size(), 2u);
}

TEST(PoseReason, Smoothing) {
  PoseReason reason = Best();
  reason.path.objective = 12.705;
  EXPECT_EQ(ReasonSentences(reason).back(), "smoothing changed the objective by +5.0 %");
  EXPECT_EQ(ReasonSentences(reason).size(), 3u);
}

}  // namespace
}  // namespace millpose
