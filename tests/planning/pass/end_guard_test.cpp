// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/end_guard.hpp"

#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

/// A ball at the wrist, and balls where it would come to, retracting from poses.
Cell CellAbove(const PoseProblem& problem, const std::vector<Joints>& poses) {
  Cell cell = EmptyCell(problem);
  cell.bodies.push_back({.name = "wrist",
                         .body_class = BodyClass::kLink,
                         .mount = Mount::kLink,
                         .link = 5,
                         .shape = Sphere{15}});
  const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  for (const Joints& q : poses) {
    Checker checker{World(EmptyCell(problem))};
    const Retract retract = FindRetract(checker, carrier, q, {problem.arm.lower, problem.arm.upper}, {});
    Body ball{.name = fmt::format("ball{}", cell.bodies.size()),
              .body_class = BodyClass::kFixture,
              .mount = Mount::kWorld,
              .shape = Sphere{15}};
    ball.X_MG.translation() =
        (problem.X_WB * LinkFrames(problem.arm, retract.joints.back())[5]).translation();
    cell.bodies.push_back(ball);
  }
  return cell;
}

struct EndFixture {
  PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-60, 60, 24);
  Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  PathOptions options = Options();
  PassResult before = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});

  bool Leaves(const World& world, const Joints& q, double share = 1) const {
    Checker checker(world, share);
    return CanLeave(checker, carrier, q, {});
  }
};

TEST(EndGuard, TakesAnotherPoseWhereAnEndCannotBeLeft) {
  EndFixture f;
  const World world(CellAbove(f.problem, {f.before.points[23].q}));
  const PassResult unguarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ASSERT_FALSE(f.Leaves(world, unguarded.points[23].q));
  ASSERT_FALSE(f.Leaves(world, unguarded.points[23].q, kClearanceShares.back()));
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ExpectSound(f.problem, f.options, f.pass, guarded);
  ASSERT_EQ(guarded.pieces.size(), 1u);
  EXPECT_EQ(guarded.pieces[0].last, 23);
  EXPECT_TRUE(f.Leaves(world, guarded.points[23].q));
  EXPECT_TRUE(f.Leaves(world, guarded.points[0].q));
  EXPECT_GT((guarded.points[23].q - unguarded.points[23].q).norm(), DegToRad(1));
  double objective = 0, least = 0;
  for (size_t t = 0; t < 24; ++t) {
    objective += guarded.points[t].objective;
    least += unguarded.points[t].objective;
  }
  EXPECT_LT(objective, 1.2 * least);
}

TEST(EndGuard, ChangesNothingWhereTheEndsAreFree) {
  EndFixture f;
  const World world(CellAbove(f.problem, {f.before.points[12].q}));  // not an end
  const PassResult unguarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ASSERT_FALSE(f.Leaves(world, unguarded.points[12].q));
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  for (size_t t = 0; t < 24; ++t) EXPECT_EQ(guarded.points[t].q, unguarded.points[t].q) << t;
}

TEST(EndGuard, APointThatNoPoseLeavesEndsThePieceBeforeIt) {
  EndFixture f;
  // A plate over the last point that the spindle's holder would meet on its way out, in every rotation.
  Cell cell = EmptyCell(f.problem);
  Body holder{.name = "holder", .body_class = BodyClass::kSpindle, .mount = Mount::kTool, .shape = Sphere{4}};
  holder.X_MG.translation().z() = 60;
  Body stop{.name = "stop", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{4}};
  const MillingPoint& last = f.pass.points[23];
  stop.X_MG.translation() = last.position + 85 * last.tool_axis;
  cell.bodies = {holder, stop};
  const World world(cell);
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ExpectSound(f.problem, f.options, f.pass, guarded);
  ASSERT_EQ(guarded.pieces.size(), 1u);
  const auto end = static_cast<size_t>(guarded.pieces[0].last);
  EXPECT_LT(end, 23u);
  EXPECT_GT(end, 16u);
  EXPECT_TRUE(f.Leaves(world, guarded.points[end].q, kClearanceShares.back()));
  for (size_t t = end + 1; t < 24; ++t) {
    EXPECT_EQ(guarded.points[t].skip, Infeasibility::kAccess) << t;
    EXPECT_NE(guarded.points[t].detail.find("holder"), std::string::npos) << guarded.points[t].detail;
  }
}

/// Asked from the best on, the search ends with the pose that it would have ended with had all been asked.
TEST(EndGuard, AskingLazilyFindsWhatAskingAllFinds) {
  EndFixture f;
  // Balls where the wrist would go to from many poses at the last point: what is left lies far down the
  // order.
  std::vector<Joints> poses;
  const PointScorer scorer(f.problem, f.pass.points.back(), f.pass.rotation_reference);
  std::vector<Candidate> candidates(8 * 40);
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < 40; ++i) rotations.push_back({f.before.points[23].freedoms[0] + DegToRad(i - 20)});
  scorer.Score(rotations, candidates);
  for (const Candidate& candidate : candidates)
    if (candidate.obstacle == Infeasibility::kNone &&
        (candidate.q - f.before.points[23].q).cwiseAbs().maxCoeff() < 1)
      poses.push_back(candidate.q);
  ASSERT_GT(poses.size(), 20u);
  const World world(CellAbove(f.problem, poses));
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ASSERT_TRUE(f.Leaves(world, guarded.points[23].q));
  // The same row where just what cannot be left there is no candidate: bodies that the pose itself would
  // touch.
  std::vector<PointScorer> scorers;
  std::vector<std::shared_ptr<PointVerdicts>> known;
  std::vector<Layer> layers;
  for (const MillingPoint& point : f.pass.points) {
    scorers.emplace_back(f.problem, point, f.pass.rotation_reference);
    known.push_back(std::make_shared<PointVerdicts>());
    layers.push_back(
        MakeLayer(scorers.back(), SeedsOf(CandidateTable::OfStep(scorers.back(), DegToRad(2))), false));
  }
  const PassChecks checks{world, f.carrier, 0.5, true, 2, {}};
  const std::vector<Joints> steps(layers.size(), f.options.steps.most);
  CandidateGraph lazy(checks, layers, steps, known), eager(checks, layers, steps, known);
  const auto best = [&](const CandidateGraph& graph) {  // of the last layer alone
    const std::vector<double>& objective = graph.layer(23).objective;
    Sequence sequence;
    sequence.nodes.assign(24, kNoNode);
    sequence.break_before.assign(24, false);
    sequence.nodes[23] = static_cast<size_t>(std::ranges::min_element(objective) - objective.begin());
    return sequence;
  };
  EndGuard guard(lazy, {}, {});
  int rounds = 0;
  while (!guard.Check(best(lazy))) ASSERT_LT(++rounds, 400);
  EXPECT_GT(rounds, 0);
  Checker checker(world);
  for (size_t k = 0; k < eager.layer(23).size(); ++k)
    if (!CanLeave(checker, f.carrier, eager.layer(23).joints.At(k), {})) eager.TakeOut(23, k);
  EXPECT_EQ(best(lazy).nodes[23], best(eager).nodes[23]);
  EXPECT_LT(lazy.nodes_pruned(), eager.nodes_pruned()) << "all nodes were asked";
}

}  // namespace
}  // namespace millpose
