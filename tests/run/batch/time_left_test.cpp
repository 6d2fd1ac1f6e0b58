// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/time_left.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

TEST(TimeLeft, IsNotKnownUntilAJobHasEnded) {
  EXPECT_FALSE(TimeLeft({{}, {100, 5}, 10, 2}));
  EXPECT_TRUE(TimeLeft({{3}, {}, 0, 1}));
}

TEST(TimeLeft, CountsWhatRunsAndWhatWaits) {
  EXPECT_DOUBLE_EQ(*TimeLeft({{10, 10}, {}, 3, 1}), 30);
  EXPECT_DOUBLE_EQ(*TimeLeft({{10, 10}, {}, 3, 2}), 20);  // the third begins when one of two ends
  EXPECT_DOUBLE_EQ(*TimeLeft({{10}, {}, 0, 4}), 0);
  // 10 s for a job: the running one has 5 left, then comes one of the two that wait.
  EXPECT_DOUBLE_EQ(*TimeLeft({{10}, {5}, 2, 2}), 5 + 10);
  // One runs for 30 s: (10 + 30) / 2 for a job, and half as long again for that one.
  EXPECT_DOUBLE_EQ(*TimeLeft({{10}, {30}, 2, 1}), 15 + 2 * 20);
}

// A dozen quick jobs and one that runs on: the speed of the quick ones says nothing of it.
TEST(TimeLeft, ALongJobIsNotTakenToEndSoon) {
  const double left = *TimeLeft({std::vector<double>(12, 1.0), {600}, 0, 2});
  EXPECT_DOUBLE_EQ(left, 300);
}

// Jobs of one length, two at a time: the answer is right at every moment.
TEST(TimeLeft, IsRightForJobsOfOneLength) {
  for (double now = 10.5; now < 50; now += 1) {  // 10 jobs of 10 s on 2 places end at 50 s
    const auto begun = static_cast<size_t>(now / 10) * 2;
    const double so_far = now - 10 * std::floor(now / 10);
    const BatchState state{std::vector<double>(begun, 10.0), {so_far, so_far}, 10 - begun - 2, 2};
    EXPECT_NEAR(*TimeLeft(state), 50 - now, 1e-9) << now;
  }
}

}  // namespace
}  // namespace millpose
