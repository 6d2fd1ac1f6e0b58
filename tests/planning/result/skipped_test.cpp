// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/skipped.hpp"

#include "planning/result/compared.hpp"
#include "planning/result/cycle_time.hpp"
#include "planning/result/stock_figures.hpp"
#include "tests/planning/result/every_field.hpp"

namespace millpose {
namespace {

/// A pass of pieces of two points each, with a skipped point between them; lifted before pieces 1 and 3.
PassResult FourPieces() {
  PassResult pass;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < 2; ++i) {
      PlannedPoint& point = pass.points.emplace_back();
      point.piece = k;
      point.point.position.x() = 10 * k + i;
      point.q = Joints::Constant(k);
      point.objective = 1 + k;
      point.own_optimum = 0.5;
      point.clearance = 7;
    }
    const int first = 3 * k;
    pass.pieces.push_back({0, k, first, first + 1, false});
    if (k == 3) continue;
    PlannedPoint& lost = pass.points.emplace_back();
    lost.skip = Infeasibility::kLimit;
    lost.detail = "A5";
    lost.piece = k;
  }
  pass.lifts = {1, 3};
  return pass;
}

TEST(LeaveOut, TheOthersStayAsTheyAreAndMoveUp) {
  const PassResult before = FourPieces();
  for (int out = 0; out < 4; ++out) {
    PassResult pass = before;
    LeaveOut(pass, out, Infeasibility::kAccess, "clamp in the way");
    ASSERT_EQ(pass.pieces.size(), 3u);
    for (size_t k = 0; k < 3; ++k) {
      const Segment& was = before.pieces[k + (static_cast<int>(k) >= out ? 1 : 0)];
      EXPECT_EQ(pass.pieces[k].piece, static_cast<int>(k));
      EXPECT_EQ(pass.pieces[k].first, was.first);
      EXPECT_EQ(pass.pieces[k].last, was.last);
      for (int t = was.first; t <= was.last; ++t) {
        PlannedPoint expected = before.points[static_cast<size_t>(t)];
        expected.piece = static_cast<int>(k);
        EXPECT_TRUE(every_field::Same(pass.points[static_cast<size_t>(t)], expected)) << out << ' ' << t;
      }
    }
    std::vector<int> lifts;
    for (const int lift : before.lifts)
      if (lift != out) lifts.push_back(lift - (lift > out ? 1 : 0));
    EXPECT_EQ(pass.lifts, lifts) << out;
  }
}

TEST(LeaveOut, ItsPointsKeepWhatHoldsOfThePointAndLoseWhatHeldOfThePose) {
  PassResult pass = FourPieces();
  LeaveOut(pass, 2, Infeasibility::kIncomplete, "others of its hole are skipped");
  for (const size_t t : {6u, 7u}) {
    const PlannedPoint& point = pass.points[t];
    EXPECT_EQ(point.skip, Infeasibility::kIncomplete);
    EXPECT_EQ(point.detail, "others of its hole are skipped");
    EXPECT_EQ(point.point.position.x(), 20 + static_cast<double>(t - 6));
    EXPECT_EQ(point.own_optimum, 0.5);
    EXPECT_EQ(point.objective, 0);
    EXPECT_EQ(point.clearance, 0);
    EXPECT_EQ(point.q, Joints::Zero());
  }
  EXPECT_EQ(pass.points[5].detail, "A5") << "skipped before, for a reason of its own";
}

TEST(LeaveOut, PieceByPieceNothingIsLeft) {
  PassResult pass = FourPieces();
  while (!pass.pieces.empty())
    LeaveOut(pass, static_cast<int>(pass.pieces.size()) - 1, Infeasibility::kAccess, "");
  EXPECT_EQ(CountSkipped(pass), pass.points.size());
  EXPECT_TRUE(pass.lifts.empty());
  PlanResult plan;
  plan.passes = {pass, FourPieces()};
  const std::map<std::string, size_t> counts{{"access", 8}, {"limit", 6}};
  EXPECT_EQ(SkippedByReason(plan), counts);
}

TEST(Compared, LeadsSkippedPointsAndAirWhereForcesAreKnownDoNotCount) {
  PassResult pass = FourPieces();
  pass.points[0].point.kind = PointKind::kLeadIn;
  const auto count = [&] { return std::ranges::count_if(pass.points, Compared({pass})); };
  EXPECT_EQ(count(), 7);
  pass.points[1].point.engagement.side = CutSide::kUp;
  EXPECT_EQ(count(), 1) << "the others cut air";
  pass.points[3].point.engagement.side = CutSide::kSlot;
  EXPECT_EQ(count(), 2);
  pass.points[3].skip = Infeasibility::kStep;
  EXPECT_EQ(count(), 1);
}

TEST(CycleTime, IsTheSumOfItsPartsAndReadsAsAClock) {
  CycleTime all{3000, 200, 60.4, 3};
  all += {600, 40, 0, 0.1};
  EXPECT_DOUBLE_EQ(all.Total(), 3903.5);
  EXPECT_EQ(ClockText(0.49), "0:00:00");
  EXPECT_EQ(ClockText(59.5), "0:01:00");
  EXPECT_EQ(ClockText(86399.6), "24:00:00");
  EXPECT_EQ(TimeText(all), "1:05:04 (cuts 1:00:00, approaches 0:04:00, gaps 0:01:00, stops 0:00:03)");
}

TEST(AirTime, ReadsAsAShare) {
  EXPECT_EQ(AirText({1000, 180, 100, 0}), "18 % of the cutting time (0:03:00) meets no material");
  EXPECT_EQ(AirText({1000, 180, 100, 60}),
            "18 % of the cutting time (0:03:00) meets no material, 0:01:00 of it at the air feed");
  EXPECT_EQ(AirText({}), "0 % of the cutting time (0:00:00) meets no material");
}

}  // namespace
}  // namespace millpose
