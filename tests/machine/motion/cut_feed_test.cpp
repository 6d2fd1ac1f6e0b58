// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/cut_feed.hpp"

#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

/// A cut along which joint j is amplitude_j · sin(s / length_j), sampled every `spacing` mm.
struct Wave {
  Joints amplitude = Joints::Zero(), length = Joints::Ones();

  Joints At(double s) const {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = amplitude[j] * std::sin(s / length[j]);
    return q;
  }
  std::vector<CutSample> Sample(double end, double spacing, double feed) const {
    std::vector<CutSample> cut;
    for (double s = 0; s <= end; s += spacing) cut.push_back({At(s), s, feed});
    return cut;
  }
};

Wave TestWave() {
  Wave wave;
  wave.amplitude << 0.2, 0.1, 0.05, 0.4, 0.3, 0.5;
  wave.length << 100, 60, 80, 50, 40, 30;
  return wave;
}

TEST(CutFeed, RatesMatchTheDerivativesOfTheCourse) {
  const Wave wave = TestWave();
  const double feed = 25;
  const std::vector<CutSample> cut = wave.Sample(300, 0.5, feed);
  const JointRates rates = RatesAlong(cut);
  for (size_t i = 1; i + 1 < cut.size(); ++i) {
    for (int j = 0; j < 6; ++j) {
      const double phase = cut[i].arc_length / wave.length[j];
      EXPECT_NEAR(rates.speed[i][j], wave.amplitude[j] * std::cos(phase) / wave.length[j] * feed, 1e-4);
      const double second = -wave.amplitude[j] * std::sin(phase) / (wave.length[j] * wave.length[j]);
      EXPECT_NEAR(rates.acceleration[i][j], second * feed * feed, 1e-3);
    }
  }
  const Joints rms = TimeRms(cut, rates.acceleration);
  EXPECT_NEAR(rms[5], 0.5 / 900 * feed * feed / std::sqrt(2), 0.02);
}

TEST(CutFeed, ShortfallsNameTheLimitingJointAndTheFeedItCanHold) {
  const Arm arm = SampleArm();
  Wave wave;
  wave.amplitude[5] = 1;
  wave.length[5] = 20;
  const auto slow = wave.Sample(130, 0.2, 10);
  EXPECT_TRUE(FindShortfalls(slow, arm.speed, arm.acceleration).empty());
  // At 60 mm/s A6 needs 3 rad/s at s = 0 (speed 1.91) and 9 rad/s² at the crest (acceleration 8.73).
  const auto fast = wave.Sample(130, 0.2, 60);
  const auto shortfalls = FindShortfalls(fast, arm.speed, arm.acceleration);
  ASSERT_FALSE(shortfalls.empty());
  EXPECT_EQ(shortfalls[0].joint, 5);
  EXPECT_FALSE(shortfalls[0].by_acceleration);
  EXPECT_NEAR(shortfalls[0].feed_possible, arm.speed[5] * 20, 0.05);
  const int crest = static_cast<int>(kPi / 2 * 20 / 0.2);
  bool found = false;
  for (const FeedShortfall& s : shortfalls) {
    if (s.sample != crest) continue;
    found = true;
    EXPECT_TRUE(s.by_acceleration);
    EXPECT_NEAR(s.feed_possible, std::sqrt(arm.acceleration[5] * 400), 0.1);
  }
  EXPECT_TRUE(found);
}

TEST(CutFeed, ReducedFeedsKeepAllLimitsAndNoneIsNeedlesslySlow) {
  const Arm arm = SampleArm();
  const Wave wave = TestWave();
  std::vector<CutSample> cut = wave.Sample(400, 1, 150);
  ASSERT_FALSE(FindShortfalls(cut, arm.speed, arm.acceleration).empty());
  const std::vector<double> feeds = ReducedFeeds(cut, arm.speed, arm.acceleration);
  double fastest = 0;
  for (size_t i = 0; i < cut.size(); ++i) {
    EXPECT_LE(feeds[i], 150);
    EXPECT_GT(feeds[i], 1);
    fastest = std::max(fastest, feeds[i]);
    cut[i].feed = feeds[i];
  }
  EXPECT_EQ(fastest, 150);
  const JointRates rates = RatesAlong(cut);
  int at_a_limit = 0, reduced = 0;
  for (size_t i = 0; i < cut.size(); ++i) {
    const double v = rates.speed[i].cwiseAbs().cwiseQuotient(arm.speed).maxCoeff();
    const double a = rates.acceleration[i].cwiseAbs().cwiseQuotient(arm.acceleration).maxCoeff();
    EXPECT_LE(v, 1 + 1e-9);
    EXPECT_LE(a, 1.15);  // the feed's slope is taken over two steps here, over one there
    reduced += feeds[i] < 150;
    at_a_limit += feeds[i] < 150 && (v > 0.99 || a > 0.8);
  }
  EXPECT_GT(reduced, 50);
  EXPECT_GT(at_a_limit, 0.9 * reduced);  // bang-bang: some joint is at its limit wherever the feed is reduced
}

TEST(CutFeed, WhatCanBeHeldIsLeftAloneAndShortCutsWork) {
  const Arm arm = SampleArm();
  const auto cut = TestWave().Sample(200, 2, 1.3);
  for (double feed : ReducedFeeds(cut, arm.speed, arm.acceleration)) EXPECT_EQ(feed, 1.3);
  for (size_t count : {0u, 1u, 2u}) {
    const std::span<const CutSample> few(cut.data(), count);
    EXPECT_EQ(ReducedFeeds(few, arm.speed, arm.acceleration).size(), count);
    EXPECT_EQ(RatesAlong(few).speed.size(), count);
  }
}

}  // namespace
}  // namespace millpose::test
