// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts in the air: how long, and at which feed.
#include "planning/standing/air_feed.hpp"

#include "planning/result/continuity.hpp"
#include "planning/result/station.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

constexpr double kCut = 80 / 60.0, kFast = 6000 / 60.0;  // mm/s

/// Two passes of a cutter of Ø 20 over a pad; of the raw part 3 mm stand, on one half of it alone: x ≤ 0.
JobInputs HalfCovered(std::vector<Override> more = {}) {
  more.insert(more.begin(), {{"workpiece.stock", "{box: {lower_mm: [-60, -60, -20], upper_mm: [0, 60, 3]}}"},
                             {"toolpath.spacing_mm", "5"}});
  return SmallInputs(std::move(more));
}

PlannedJob PlanAtAirFeed(JobInputs inputs, AirFeedSettings air) {
  inputs.cell.air_feed = air;
  return PlanJob(inputs, NoCheckpoints(), {.threads = 2});
}

/// Calls `visit(from, to, point)` for the tips of each motion of a cut, P.
template <class Visit>
void ForEachCut(const PlanResult& plan, const Visit& visit) {
  for (const PassResult& pass : plan.passes)
    for (const Segment& piece : pass.pieces)
      for (int t = piece.first + 1; t <= piece.last; ++t)
        visit(ToolAt(plan, pass, static_cast<size_t>(t) - 1).translation(),
              ToolAt(plan, pass, static_cast<size_t>(t)).translation(), pass.points[static_cast<size_t>(t)]);
}

// The tool is within 10 mm of x; what it passes beyond x = 10 meets nothing, and beyond 15 nothing is near.
TEST(AirFeed, CutsInTheAirAreTold) {
  const PlannedJob job = PlanJob(HalfCovered(), NoCheckpoints(), {.threads = 2});
  double cuts = 0, nothing = 0, either = 0, clear = 0, doubtful = 0;
  ForEachCut(job.plan,
             [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, const PlannedPoint& point) {
               const double seconds = (to - from).norm() / point.point.feed_rate;
               const double gap = std::min(from.x(), to.x()) - 10;
               cuts += seconds;
               if (gap > 0.1) nothing += seconds;
               if (gap > 5) clear += seconds;
               // What the lattice of 0.5 mm does not know.
               if (gap > -0.6 && gap < 0.1) either += seconds;
               if (gap > 5 && gap < 6) doubtful += seconds;
               EXPECT_NEAR(point.point.feed_rate, kCut, 1e-9);
             });
  ASSERT_TRUE(job.stock);
  EXPECT_GT(clear, 0.2 * cuts);
  EXPECT_NEAR(job.stock->air.cuts, cuts, 1e-6 * cuts);
  EXPECT_NEAR(job.stock->air.nothing, nothing, either + 1e-6 * cuts);
  EXPECT_NEAR(job.stock->air.clear, clear, doubtful + 1e-6 * cuts);
  EXPECT_EQ(job.stock->air.air_feed, 0);
}

TEST(AirFeed, IsRunWhereNothingIsNearInAllPrograms) {
  const std::vector<Override> all{{"programs", "[krl, sinumerik, linuxcnc]"}};
  const PlannedJob slow = PlanJob(HalfCovered(all), NoCheckpoints(), {.threads = 2});
  const PlannedJob fast = PlanAtAirFeed(HalfCovered(all), {kFast, 5, 10});
  size_t raised = 0;
  ForEachCut(fast.plan,
             [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, const PlannedPoint& point) {
               if (point.point.feed_rate > kCut * (1 + 1e-9)) {
                 ++raised;
                 EXPECT_LE(point.point.feed_rate, kFast);
                 EXPECT_GE(std::min(from.x(), to.x()) - 10, 5);
               } else {
                 EXPECT_NEAR(point.point.feed_rate, kCut, 1e-9);
               }
             });
  EXPECT_GT(raised, 4u);
  EXPECT_GT(fast.stock->air.air_feed, 0);
  EXPECT_LT(fast.stock->air.cuts, 0.9 * slow.stock->air.cuts);
  EXPECT_TRUE(AnalyseContinuity(fast.plan).feed_not_held.empty());
  ASSERT_EQ(fast.programs.programs.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const CheckedProgram& program = fast.programs.programs[i];
    EXPECT_TRUE(program.Confirmed()) << program.WhyWithheld();
    // The program takes as much less as the plan says.
    const double saved = slow.programs.programs[i].time.all.cuts - program.time.all.cuts;
    EXPECT_NEAR(saved, slow.stock->air.cuts - fast.stock->air.cuts, 0.01 * saved) << program.controller;
    EXPECT_TRUE(std::ranges::any_of(program.files, [](const auto& file) {
      return file.second.find("air_feed") != std::string::npos;
    })) << program.controller;
    EXPECT_EQ(program.speed->slow.size(), slow.programs.programs[i].speed->slow.size());
  }
}

TEST(AirFeed, WaysThatAreShortOrNearStayAsTheyAre) {
  const auto raised = [](AirFeedSettings air) {
    return PlanAtAirFeed(HalfCovered(), air).stock->air.air_feed;
  };
  EXPECT_GT(raised({kFast, 5, 10}), 0);
  EXPECT_EQ(raised({kFast, 5, 1000}), 0);
  EXPECT_EQ(raised({kFast, 60, 10}), 0);
  EXPECT_EQ(raised({kCut / 2, 5, 10}), 0);  // what is faster stays so
}

// Without a raw part nobody knows where air is.
TEST(AirFeed, NeedsAStock) {
  const PlannedJob job = PlanAtAirFeed(SmallInputs({{"toolpath.spacing_mm", "5"}}), {kFast, 5, 10});
  EXPECT_FALSE(job.stock);
  ForEachCut(job.plan, [](const auto&, const auto&, const PlannedPoint& point) {
    EXPECT_NEAR(point.point.feed_rate, kCut, 1e-9);
  });
}

// Where feeds are kept, those in the air are still no faster than the axes.
TEST(AirFeed, IsHeldByTheAxesAlsoWhereFeedsAreKept) {
  const PlannedJob job = PlanAtAirFeed(HalfCovered({{"process.feed", "keep"}}), {2e5 / 60, 5, 10});
  EXPECT_GT(job.stock->air.air_feed, 0);
  EXPECT_TRUE(AnalyseContinuity(job.plan).feed_not_held.empty());
}

}  // namespace
}  // namespace millpose::test
