// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_link_moves.hpp"

#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

const Joints kLeft = Degrees(35, -63.9, 103.3, 18.8, 53.1, 16.2);
const Joints kRight = Degrees(-35, -63.9, 103.3, 18.8, 53.1, 16.2);

/// A pass with a piece of three points at each of some poses.
PassResult PassAt(int number, const std::vector<Joints>& poses) {
  PassResult pass;
  pass.pass = number;
  for (size_t k = 0; k < poses.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      PlannedPoint& point = pass.points.emplace_back();
      point.q = poses[k] + Joints::Constant(0.001 * i);
      point.piece = static_cast<int>(k);
      point.own_optimum = 7;
    }
    const int first = 3 * static_cast<int>(k);
    pass.pieces.push_back({number, static_cast<int>(k), first, first + 2, false});
  }
  pass.lifts = {1};
  return pass;
}

/// A clamp over the spindle at kLeft, so that there is no way out of that pose.
Cell ClampedCell() {
  Cell cell = SampleCell();
  cell.bodies.push_back({"clamp", BodyClass::kFixture, Mount::kWorld, 0,
                         ForwardFlange(cell.arm, kLeft) * cell.X_FT * At(90, 0, 280), Box{{40, 40, 40}}});
  return cell;
}

TEST(PlanAllLinkMoves, APieceThatCannotBeLeftCostsItselfAlone) {
  const World world(ClampedCell());
  std::vector<PassResult> passes{PassAt(0, {kRight}), PassAt(1, {kLeft, kRight}), PassAt(2, {kRight})};
  const PlannedLinkMoves planned =
      PlanAllLinkMoves(Stations(world, {}), passes, {}, NoCheckpoints(), {.threads = 2});
  ASSERT_EQ(planned.gaps.size(), 4u);  // home, three pieces, home
  for (const LinkMove& gap : planned.gaps) EXPECT_TRUE(gap.planned) << gap.detail;
  EXPECT_EQ(planned.gaps[1].to_pass, 1);
  EXPECT_EQ(planned.gaps[1].to_piece, 0);
  ASSERT_EQ(passes[1].pieces.size(), 1u);
  EXPECT_EQ(passes[1].pieces[0].piece, 0);
  EXPECT_EQ(passes[1].pieces[0].first, 3);
  EXPECT_EQ(passes[1].lifts, std::vector<int>{0});
  for (size_t t = 0; t < 6; ++t) {
    const PlannedPoint& point = passes[1].points[t];
    EXPECT_EQ(point.own_optimum, 7);
    EXPECT_EQ(point.skip, t < 3 ? Infeasibility::kAccess : Infeasibility::kNone) << t;
    if (t >= 3) {
      EXPECT_EQ(point.piece, 0);
    } else {
      EXPECT_NE(point.detail.find("spindle touches clamp"), std::string::npos) << point.detail;
    }
  }
}

TEST(PlanAllLinkMoves, OfATrialSomePassesAreThereOnly) {
  const World world(ClampedCell());
  std::vector<PassResult> passes{PassAt(10, {kRight}), PassAt(20, {kLeft, kRight}), PassAt(30, {kRight})};
  const PlannedLinkMoves planned =
      PlanAllLinkMoves(Stations(world, {}), passes, {}, NoCheckpoints(), {.threads = 2});
  for (const LinkMove& gap : planned.gaps) EXPECT_TRUE(gap.planned) << gap.detail;
  EXPECT_EQ(passes[1].pieces.size(), 1u);  // the left one cannot be reached
  EXPECT_EQ(passes[0].pieces.size(), 1u);
}

TEST(PlanAllLinkMoves, WhereNoWayIsFoundBetweenPiecesItGoesByHome) {
  Cell cell = SampleCell();
  cell.bodies.push_back(
      {"wall", BodyClass::kFixture, Mount::kWorld, 0, At(2100, 0, 700), Box{{1400, 100, 1400}}});
  const World world(cell);
  LinkMoveOptions options;
  options.max_iterations = 1;  // straight ways alone
  std::vector<PassResult> passes{PassAt(0, {kLeft}), PassAt(1, {kRight})};
  const Joints left = passes[0].points[2].q, right = passes[1].points[0].q;
  ASSERT_FALSE(PlanLinkMove(world, {0, 0, left}, {1, 0, right}, options, {}).planned);
  const PlannedLinkMoves planned =
      PlanAllLinkMoves(Stations(world, {}), passes, options, NoCheckpoints(), {.threads = 1});
  ASSERT_EQ(planned.gaps.size(), 3u);
  const LinkMove& gap = planned.gaps[1];
  ASSERT_TRUE(gap.planned) << gap.detail;
  EXPECT_EQ(std::pair(gap.from_pass, gap.to_pass), std::pair(0, 1));
  const Carrier carrier{cell.arm, cell.X_WB, cell.X_FT};
  EXPECT_TRUE(carrier.ToolPose(gap.joints.front()).isApprox(gap.X_WT_retracted, 1e-9));
  EXPECT_TRUE(carrier.ToolPose(gap.joints.back()).isApprox(gap.X_WT_approach, 1e-9));
  EXPECT_EQ(std::ranges::count(gap.joints, cell.home), 1);
  Checker checker(world);
  for (size_t i = 1; i < gap.joints.size(); ++i)
    EXPECT_FALSE(checker.Between(gap.joints[i - 1], gap.joints[i], Phase::kFree, 0.5)) << i;
  EXPECT_EQ(passes[0].pieces.size() + passes[1].pieces.size(), 2u);
}

TEST(PlanAllLinkMoves, NothingIsLeftOutWhereHomeIsBlocked) {
  Cell cell = ClampedCell();
  cell.home = kLeft;
  std::vector<PassResult> passes{PassAt(0, {kRight})};
  const PlannedLinkMoves planned =
      PlanAllLinkMoves(Stations(World(cell), {}), passes, {}, NoCheckpoints(), {.threads = 1});
  EXPECT_FALSE(planned.gaps[0].planned);
  EXPECT_EQ(passes[0].pieces.size(), 1u);
}

}  // namespace
}  // namespace millpose::test
