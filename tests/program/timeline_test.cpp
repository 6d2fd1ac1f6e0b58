// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "machine/robot/kinematics.hpp"
#include "program/make_timeline.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

size_t CountOf(const Timeline& timeline, RunPart stretch) {
  return static_cast<size_t>(std::ranges::count(timeline, stretch, &RunInstant::stretch));
}

TEST(Timeline, EndsWhenTheProgramDoes) {
  const PlanResult plan = SamplePlan();
  const TimeOptions times{.way_speed_share = 0.3};
  const Timeline timeline = MakeTimeline(plan, SampleFeeds(), times);
  const ProgramTime time = MeasureTime(MakeMotionProgram(plan, SampleFeeds()), plan.arm, times);
  EXPECT_NEAR(timeline.back().time, time.all.Total(), 1e-9);
  EXPECT_EQ(timeline.front().time, 0);
  EXPECT_EQ(timeline.front().q, plan.home);
  EXPECT_EQ(timeline.back().q, plan.home);
  EXPECT_EQ(timeline.back().pass, -1);
  for (size_t i = 1; i < timeline.size(); ++i) EXPECT_GE(timeline[i].time, timeline[i - 1].time) << i;
}

// A page that interpolates between instants shows the arm where it is.
TEST(Timeline, TheToolIsWhereTheJointsPutItAndInstantsLieClose) {
  const PlanResult plan = SamplePlan();
  const Timeline timeline = MakeTimeline(plan, SampleFeeds(), {});
  for (size_t i = 0; i < timeline.size(); ++i) {
    const Pose X_WT = plan.X_WB * ForwardFlange(plan.arm, timeline[i].q) * plan.X_FT;
    EXPECT_LT((X_WT.translation() - timeline[i].tip).norm(), 1e-6) << i;
    if (i == 0) continue;
    EXPECT_LT((timeline[i].q - timeline[i - 1].q).cwiseAbs().maxCoeff(), 0.0873 + 1e-9) << i;
  }
}

TEST(Timeline, HasEveryPlannedPointOnceAtItsPlace) {
  PlanResult plan = SamplePlan();
  plan.passes[1].points[2].skip = Infeasibility::kGouge;
  plan.passes[0].points[0].point.kind = PointKind::kLeadIn;
  plan.passes[0].points[1].point.kind = PointKind::kLeadIn;
  const Timeline timeline = MakeTimeline(plan, SampleFeeds(), {});
  for (const PassResult& pass : plan.passes)
    for (int i = 0; i < static_cast<int>(pass.points.size()); ++i) {
      const PlannedPoint& point = pass.points[static_cast<size_t>(i)];
      const auto here = [&](const RunInstant& at) {
        return at.pass == pass.pass && at.point == i && at.q == point.q;
      };
      const bool twice = pass.pieces[0].closed && i == 0;  // a ring's first point
      EXPECT_EQ(std::ranges::count_if(timeline, here), point.skip != Infeasibility::kNone ? 0
                                                       : twice                            ? 2
                                                                                          : 1)
          << pass.pass << " " << i;
      const auto found = std::ranges::find_if(timeline, here);
      if (found != timeline.end()) {
        EXPECT_LT((found->tip - point.point.position).norm(), 1e-6);
      }
    }
  EXPECT_EQ(CountOf(timeline, RunPart::kLead), 1u);  // the way to the second; the first ends the approach
  for (const RunPart stretch : {RunPart::kCut, RunPart::kApproach, RunPart::kRetract, RunPart::kLinkMove})
    EXPECT_GT(CountOf(timeline, stretch), 2u);
  EXPECT_EQ(CountOf(timeline, RunPart::kMissing), 0u);
}

TEST(Timeline, LeapsOverAGapThatCouldNotBePlanned) {
  PlanResult plan = SamplePlan();
  const double whole = MakeTimeline(plan, SampleFeeds(), {}).back().time;
  plan.gaps[1].planned = false;
  plan.gaps[1].joints.clear();
  const Timeline timeline = MakeTimeline(plan, SampleFeeds(), {});
  EXPECT_EQ(CountOf(timeline, RunPart::kMissing), 1u);
  EXPECT_LT(timeline.back().time, whole);
  const auto leap = std::ranges::find(timeline, RunPart::kMissing, &RunInstant::stretch);
  EXPECT_EQ(leap->time, (leap - 1)->time);
  EXPECT_EQ(leap->q, plan.passes[1].points.front().q);
  EXPECT_EQ((leap - 1)->q, plan.passes[0].points.back().q);
  EXPECT_EQ(leap->pass, 1);
}

TEST(Timeline, IsEmptyWhereNothingIsPlanned) {
  PlanResult plan = SamplePlan();
  plan.gaps.clear();
  EXPECT_TRUE(MakeTimeline(plan, {}, {}).empty());
}

}  // namespace
}  // namespace millpose
