// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/commanded_free.hpp"

#include <gtest/gtest.h>

#include "planning/result/skipped.hpp"
#include "tests/planning/compensation/forced_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

constexpr double kJustFree = 10.6;  // mm: the cell asks for 10

/// The sample's cell with a long bar above the cutter, `height` (mm) over the first pass.
Cell WithBar(const PlanResult& plan, double height) {
  Cell cell = SampleCell(plan);
  Body bar;
  bar.name = "bar";
  bar.body_class = BodyClass::kFixture;
  bar.shape = Box{Eigen::Vector3d(30, 400, 4)};
  bar.X_MG.translation() = plan.passes[0].points[0].point.position + Eigen::Vector3d(-40, 0, height);
  cell.bodies.push_back(bar);
  return cell;
}

double ClearanceUnder(const PlanResult& plan, double height) {
  const World world(WithBar(plan, height));
  Checker checker(world);
  double least = 50;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      least = std::min(least, checker.Clearance(point.q, Phase::kCutting, 50));
  return least;
}

struct Silent final : Progress {
  void Begin(std::string_view, size_t) override {}
  void Advance(size_t) override {}
  void End(std::string_view) override {}
};

/// The sample's plan, commanded 1.9 mm higher.
PlanResult Lifted() {
  PlanResult plan = Forced();
  CompensationOptions options;
  options.most = 2;
  options.weight = [&](const Joints&) -> Eigen::Vector3d {
    return plan.X_WB.linear().transpose() * Eigen::Vector3d(0, 0, -1.9);
  };
  Compensate(options, ForcesOf(plan), plan);
  return plan;
}

/// The least height (mm, to 0.01) of a bar of which the nominal poses are just free.
double JustFreeHeight(const PlanResult& plan) {
  double low = 20, high = 600;
  EXPECT_LT(ClearanceUnder(plan, low), kJustFree);
  EXPECT_GT(ClearanceUnder(plan, high), kJustFree);
  while (high - low > 0.01) {
    const double middle = (low + high) / 2;
    (ClearanceUnder(plan, middle) < kJustFree ? low : high) = middle;
  }
  return high;
}

TEST(CommandedFree, APieceThatItsShiftsBringTooNearRunsAtItsNominalPoses) {
  const PlanResult plan = Lifted();
  const double high = JustFreeHeight(plan);
  Silent progress;
  const Execution execution{1, progress, {}};
  PlanResult far = plan, near = plan;
  EXPECT_TRUE(
      KeepCommandedFree(Stations(World(WithBar(plan, high + 10)), {}), {}, 0.5, execution, far).empty());
  EXPECT_EQ(Serialise(far), Serialise(plan));
  const std::vector<std::string> told =
      KeepCommandedFree(Stations(World(WithBar(plan, high)), {}), {}, 0.5, execution, near);
  ASSERT_FALSE(told.empty());
  EXPECT_NE(told[0].find("is not compensated"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("bar"), std::string::npos) << told[0];
  size_t nominal = 0;
  for (const PassResult& pass : near.passes) nominal += pass.points[1].compensation->q == pass.points[1].q;
  EXPECT_EQ(nominal, told.size());
  EXPECT_LT(nominal, near.passes.size());
}

TEST(CommandedFree, AReserveIsWhatClearancesMayFallShortBy) {
  const PlanResult plan = Lifted();
  const Stations stations(World(WithBar(plan, JustFreeHeight(plan))), {});
  Silent progress;
  const Execution execution{1, progress, {}};
  // Commanded, 8.7 of the 10 mm are left.
  EXPECT_FALSE(BlockedWhereCommanded(stations, 0.5, 0, execution, plan).empty());
  EXPECT_FALSE(BlockedWhereCommanded(stations, 0.5, 0.5, execution, plan).empty());
  EXPECT_TRUE(BlockedWhereCommanded(stations, 0.5, 2, execution, plan).empty());
}

TEST(CommandedFree, BlockedPiecesAreLeftOutWithTheirReasonAndTheOthersStay) {
  PlanResult plan = Lifted();
  const Stations stations(World(WithBar(plan, JustFreeHeight(plan))), {});
  Silent progress;
  const std::vector<BlockedPiece> blocked = BlockedWhereCommanded(stations, 0.5, 0, {1, progress, {}}, plan);
  ASSERT_FALSE(blocked.empty());
  size_t in_them = 0, pieces = 0;
  for (const PassResult& pass : plan.passes) pieces += pass.pieces.size();
  for (const BlockedPiece& one : blocked) {
    const Segment& piece = plan.passes[one.pass].pieces[one.piece];
    in_them += static_cast<size_t>(piece.last - piece.first + 1);
  }
  EXPECT_EQ(LeaveOutPieces(blocked, Infeasibility::kInterference, plan), blocked.size());
  EXPECT_EQ(SkippedByReason(plan), (std::map<std::string, size_t>{{"interference", in_them}}));
  size_t left = 0;
  for (const PassResult& pass : plan.passes) left += pass.pieces.size();
  EXPECT_EQ(left, pieces - blocked.size());
  EXPECT_GT(left, 0U);
}

}  // namespace
}  // namespace millpose
