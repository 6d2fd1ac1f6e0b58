// SPDX-License-Identifier: GPL-3.0-or-later
#include <ompl/util/RandomNumbers.h>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "machine/motion/time_law.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/links/link_move_planner.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

const Joints kLeft = Degrees(35, -63.9, 103.3, 18.8, 53.1, 16.2);
const Joints kRight = Degrees(-35, -63.9, 103.3, 18.8, 53.1, 16.2);

LinkMoveEnd Piece0(int pass, const Joints& q) { return {pass, 0, q}; }
LinkMoveEnd Home() { return {-1, -1, HomePose()}; }

/// A box that stands still, about a place in the frame of the tool when the arm is at `q`.
void AddBox(Cell& cell, const std::string& name, const Joints& q, const Pose& X_TG,
            const Eigen::Vector3d& size) {
  cell.bodies.push_back({name, BodyClass::kFixture, Mount::kWorld, 0,
                         ForwardFlange(cell.arm, q) * cell.X_FT * X_TG, Box{size}});
}

/// A wall in front of the robot, between the two milling poses, low enough to go over.
Cell WallCell() {
  Cell cell = SampleCell();
  cell.bodies.push_back(
      {"wall", BodyClass::kFixture, Mount::kWorld, 0, At(2100, 0, 700), Box{{1400, 100, 1400}}});
  return cell;
}

/// What the planner promises of a planned gap, checked from outside.
void ExpectGood(const World& world, const LinkMove& gap, const LinkMoveEnd& from, const LinkMoveEnd& to) {
  ASSERT_TRUE(gap.planned) << gap.detail;
  const Cell& cell = world.cell();
  const auto tool = [&](const Joints& q) { return cell.X_WB * ForwardFlange(cell.arm, q) * cell.X_FT; };
  EXPECT_LT((tool(gap.joints.front()).matrix() - gap.X_WT_retracted.matrix()).norm(), 1e-6);
  EXPECT_LT((tool(gap.joints.back()).matrix() - gap.X_WT_approach.matrix()).norm(), 1e-6);
  if (from.pass >= 0) {
    const Pose moved = tool(from.q).inverse() * gap.X_WT_retracted;
    EXPECT_LT(moved.translation().head<2>().norm(), 1e-6);  // along the tool axis
    EXPECT_GT(moved.translation().z(), 1);
  } else {
    EXPECT_EQ(gap.joints.front(), from.q);
  }
  Checker checker(world);
  double nearest = 1e9;
  for (size_t i = 0; i + 1 < gap.joints.size(); ++i) {
    for (int k = 0; k <= 400; ++k) {
      const Joints q = gap.joints[i] + k / 400.0 * (gap.joints[i + 1] - gap.joints[i]);
      nearest = std::min(nearest, checker.Clearance(q, Phase::kFree, 100));
      for (int j = 0; j < 6; ++j) {
        EXPECT_GE(q[j], cell.arm.lower[j]);
        EXPECT_LE(q[j], cell.arm.upper[j]);
      }
    }
  }
  EXPECT_GE(nearest, cell.clearances.free - 0.5 - 1e-9);
  EXPECT_LE(nearest, gap.clearance + 1e-9);  // sampled more finely than the planner did
  EXPECT_GE(nearest, gap.clearance - 20);
  EXPECT_GE(gap.duration, PathDuration(gap.joints, 0.5 * cell.arm.speed, 0.5 * cell.arm.acceleration));
  EXPECT_EQ(gap.from_pass, from.pass);
  EXPECT_EQ(gap.to_pass, to.pass);
}

TEST(LinkMove, StraightWhereNothingIsInTheWay) {
  const World world(SampleCell());
  const LinkMove gap = PlanLinkMove(world, Home(), Piece0(0, kLeft), {}, {});
  ExpectGood(world, gap, Home(), Piece0(0, kLeft));
  EXPECT_EQ(gap.joints.size(), 2u);
  const LinkMove back = PlanLinkMove(world, Piece0(0, kLeft), Home(), {}, {});
  ExpectGood(world, back, Piece0(0, kLeft), Home());
  EXPECT_EQ(back.joints.back(), HomePose());
}

TEST(LinkMove, GoesRoundAWall) {
  const World world(WallCell());
  ASSERT_TRUE(Checker(world).Between(kLeft, kRight, Phase::kFree));
  const LinkMove gap = PlanLinkMove(world, Piece0(0, kLeft), Piece0(1, kRight), {}, {});
  ExpectGood(world, gap, Piece0(0, kLeft), Piece0(1, kRight));
  EXPECT_GT(gap.joints.size(), 2u);
  // Shortened: not many times the time of the blocked straight way.
  const Arm arm = SampleArm();
  const std::vector<Joints> straight{kLeft, kRight};
  EXPECT_LT(gap.duration, 6 * PathDuration(straight, 0.5 * arm.speed, 0.5 * arm.acceleration));
}

TEST(LinkMove, KeepsALimitThatCouplesAxes) {
  Cell cell = WallCell();
  const LinkMoveEnd from = Piece0(0, kLeft), to = Piece0(1, kRight);
  const LinkMove free = PlanLinkMove(World(cell), from, to, {}, {});
  CoupledLimit limit;
  const auto most = [&](const LinkMove& gap) {
    double largest = -1e9;
    for (const Joints& q : gap.joints) largest = std::max(largest, limit.factors.dot(q));
    return largest;
  };
  // A sum that grows on the way over the wall; free ways in the joints grow between their ends by corners
  // alone.
  double growth = 0;
  for (const double of_second : {-1, 1})
    for (const double of_third : {-1, 1}) {
      limit.factors = (Joints() << 0, of_second, of_third, 0, 0, 0).finished();
      const double at_ends =
          std::max(limit.factors.dot(free.joints.front()), limit.factors.dot(free.joints.back()));
      if (most(free) - at_ends <= growth) continue;
      growth = most(free) - at_ends;
      limit.at_most = at_ends + 0.8 * growth + LinkMoveOptions{}.leave.limit_margin;
      cell.arm.coupled_limits = {limit};
    }
  ASSERT_GT(growth, DegToRad(2));
  limit = cell.arm.coupled_limits.front();
  ASSERT_GT(most(free), limit.at_most - LinkMoveOptions{}.leave.limit_margin) << "it binds";
  const World world(cell);
  const LinkMove gap = PlanLinkMove(world, from, to, {}, {});
  ASSERT_TRUE(gap.planned);
  ExpectGood(world, gap, from, to);
  EXPECT_LE(most(gap), limit.at_most - LinkMoveOptions{}.leave.limit_margin + 1e-9);
}

TEST(LinkMove, ARetractKeepsALimitThatCouplesAxes) {
  Cell cell = SampleCell();
  const auto retract = [&] {
    const World world(cell);
    Checker checker(world);
    const Carrier carrier{cell.arm, cell.X_WB, cell.X_FT};
    return FindRetract(checker, carrier, kLeft, LimitsAround(cell.arm, DegToRad(1), kLeft), {});
  };
  const Retract free = retract();
  ASSERT_TRUE(free.problem.empty()) << free.problem;
  Joints factors = Joints::Zero();
  factors.segment<2>(1) = (free.joints.back() - kLeft).segment<2>(1);  // what grows on the way out
  ASSERT_GT(factors.norm(), 1e-3);
  cell.arm.coupled_limits = {{factors, factors.dot(kLeft)}};
  EXPECT_NE(retract().problem.find("is above"), std::string::npos) << retract().problem;
}

TEST(LinkMove, BlockedEndsAreNamed) {
  Cell cell = SampleCell();
  AddBox(cell, "clamp", kLeft, At(90, 0, 280), {40, 40, 40});
  const World world(cell);
  const LinkMove gap = PlanLinkMove(world, Piece0(3, kLeft), Home(), {}, {});
  EXPECT_FALSE(gap.planned);
  EXPECT_NE(gap.detail.find("retract from pass 3, piece 0"), std::string::npos) << gap.detail;
  EXPECT_NE(gap.detail.find("spindle touches clamp"), std::string::npos) << gap.detail;
  cell.home = kLeft;
  const LinkMove blocked_home = PlanLinkMove(World(cell), {-1, -1, kLeft}, Piece0(0, kRight), {}, {});
  EXPECT_FALSE(blocked_home.planned);
  EXPECT_NE(blocked_home.detail.find("retract from home: spindle touches clamp"), std::string::npos)
      << blocked_home.detail;
}

TEST(LinkMove, NarrowPlacesArePassedWithLessClearanceAndSaySo) {
  Cell cell = SampleCell();
  // 7 mm beside the spindle, along the whole way that it retracts.
  AddBox(cell, "post", kLeft, At(97, 0, 350), {20, 40, 700});
  const World world(cell);
  const LinkMove gap = PlanLinkMove(world, Piece0(0, kLeft), Home(), {}, {});
  ASSERT_TRUE(gap.planned) << gap.detail;
  EXPECT_NE(gap.detail.find("clearances reduced to 50 %"), std::string::npos) << gap.detail;
  EXPECT_NE(gap.detail.find("spindle is 7.00 mm from post"), std::string::npos) << gap.detail;
  EXPECT_GE(gap.clearance, 4.5);
}

TEST(LinkMove, WithoutAWayTheObstacleIsNamed) {
  Cell cell = SampleCell();
  // Nothing passes beyond 1.3 m, and the arm cannot fold: its limits lie close about the milling poses.
  cell.bodies.push_back(
      {"barrier", BodyClass::kFixture, Mount::kWorld, 0, At(6300, 0, 0), Box{{10000, 100, 10000}}});
  for (const auto& [joint, lower, upper] : {std::tuple(0, -90, 90), {1, -75, -50}, {2, 90, 115}}) {
    cell.arm.lower[joint] = DegToRad(lower), cell.arm.upper[joint] = DegToRad(upper);
  }
  const World world(cell);
  LinkMoveOptions options;
  options.max_iterations = 60;
  Joints left = kLeft, right = kRight;
  left[0] = DegToRad(65), right[0] = DegToRad(-65);
  const LinkMove gap = PlanLinkMove(world, Piece0(0, left), Piece0(1, right), options, {});
  EXPECT_FALSE(gap.planned);
  EXPECT_NE(gap.detail.find("no path found in 60 iterations"), std::string::npos) << gap.detail;
  EXPECT_NE(gap.detail.find("barrier and"), std::string::npos) << gap.detail;
}

TEST(LinkMove, LongerRetractOutOfAPocket) {
  Cell cell = SampleCell();
  cell.X_WP = ForwardFlange(cell.arm, kLeft) * cell.X_FT;
  // The tip stands on the floor of a pocket 58 mm deep, 5 mm beside its wall.
  cell.bodies.push_back(
      {"floor", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, At(0, 0, -10), Box{{60, 60, 20}}});
  cell.bodies.push_back(
      {"wall", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, At(0, 65, 24), Box{{60, 100, 68}}});
  const World world(cell);
  const LinkMove gap = PlanLinkMove(world, Piece0(0, kLeft), Home(), {}, {});
  ExpectGood(world, gap, Piece0(0, kLeft), Home());
  const double height = (cell.X_WP.inverse() * gap.X_WT_retracted).translation().z();
  EXPECT_NEAR(height, 100, 1e-6);  // at 50 mm the cutter is still beside the wall
}

TEST(LinkMoves, SameBytesForAnyNumberOfThreads) {
  const World world(WallCell());
  std::vector<PassResult> passes;
  for (int p = 0; p < 4; ++p) {
    PassResult pass;
    pass.pass = p;
    for (int i = 0; i < 3; ++i) {
      PlannedPoint point;
      point.q = (p % 2 ? kRight : kLeft) + Joints::Constant(0.001 * i);
      pass.points.push_back(point);
    }
    pass.pieces.push_back({p, 0, 0, 2, false});
    passes.push_back(pass);
  }
  const auto bytes = [&](int threads) {
    const auto ends = LinkMoveEnds({-1, -1, world.cell().home, {}}, passes);
    std::vector<LinkMove> gaps(ends.size());
    ParallelFor(ends.size(), threads, {},
                [&](size_t i) { gaps[i] = PlanLinkMove(world, ends[i].first, ends[i].second, {}, {}); });
    std::string text;
    for (const LinkMove& gap : gaps) {
      text += fmt::format("{} {} {} {}\n", gap.planned, gap.detail, gap.clearance, gap.duration);
      for (const Joints& q : gap.joints) {
        for (double v : q) text += fmt::format("{} ", v);
      }
    }
    return text;
  };
  const std::string one = bytes(1);
  EXPECT_EQ(one.substr(0, 4), "true");
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 5);
  EXPECT_EQ(bytes(2), one);
  EXPECT_EQ(bytes(4), one);
}

TEST(LinkMoves, OneGapDoesNotDependOnOthersPlannedBefore) {
  const World world(WallCell());
  const auto bytes = [&](int pass) {
    const LinkMove gap = PlanLinkMove(world, Piece0(pass, kLeft), Piece0(pass + 1, kRight), {}, {});
    std::string text = fmt::format("{} {}\n", gap.planned, gap.duration);
    for (const Joints& q : gap.joints) {
      for (double v : q) text += fmt::format("{} ", v);
    }
    return text;
  };
  const std::string alone = bytes(7);
  const std::string other = bytes(1);
  EXPECT_NE(other, alone);  // a stream of its own
  EXPECT_EQ(bytes(7), alone);
}

TEST(LinkMoves, OmplsOwnGeneratorDoesNotMatter) {
  const World world(WallCell());
  const auto corners = [&] {
    return PlanLinkMove(world, Piece0(0, kLeft), Piece0(1, kRight), {}, {}).joints;
  };
  const std::vector<Joints> first = corners();
  ASSERT_GT(first.size(), 2u) << "OMPL had to search";
  // OMPL seeds every generator that it makes from one for the whole process.
  for (int used = 1; used < 4; ++used) {
    for (int i = 0; i < 5 * used; ++i) ompl::RNG().uniform01();
    EXPECT_EQ(corners(), first);
  }
}

TEST(LinkMoves, HomeInCollisionCostsItsOwnGapsAlone) {
  Cell cell = SampleCell();
  AddBox(cell, "clamp", HomePose(), At(90, 0, 280), {40, 40, 40});
  std::vector<PassResult> passes(2);
  for (int p = 0; p < 2; ++p) {
    passes[p].pass = p;
    passes[p].points.resize(2);
    for (PlannedPoint& point : passes[p].points) point.q = p ? kRight : kLeft;
    passes[p].pieces.push_back({p, 0, 0, 1, false});
  }
  const World world(cell);
  std::vector<LinkMove> gaps;
  for (const auto& [from, to] : LinkMoveEnds({-1, -1, HomePose(), {}}, passes))
    gaps.push_back(PlanLinkMove(world, from, to, {}, {}));
  ASSERT_EQ(gaps.size(), 3u);
  EXPECT_FALSE(gaps[0].planned);
  EXPECT_NE(gaps[0].detail.find("home: spindle touches clamp"), std::string::npos) << gaps[0].detail;
  EXPECT_TRUE(gaps[1].planned) << gaps[1].detail;
  EXPECT_FALSE(gaps[2].planned);
  EXPECT_GT(gaps[1].poses_checked, 0);
}

TEST(LinkMoves, StopIsHeard) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(PlanLinkMove(World(WallCell()), Piece0(0, kLeft), Piece0(1, kRight), {}, source.get_token()),
               Interrupted);
}

}  // namespace
}  // namespace millpose::test
