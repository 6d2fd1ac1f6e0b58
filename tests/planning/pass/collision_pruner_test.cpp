// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/collision_pruner.hpp"

#include "planning/ladder/table_layer.hpp"
#include "planning/pass/cut_check.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

/// A row of points with a ball where the wrist would stand at its middle, and steps long enough to lead
/// through it.
struct LongSteps {
  PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-60, 60, 12);
  std::vector<PointScorer> scorers;
  World world{CellWithBallAt(
      problem, PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2}), 6, 40)};
  PassChecks checks{world, {problem.arm, problem.X_WB, problem.X_FT}, 0.5, true, 2, {}};

  LongSteps() {
    for (const MillingPoint& point : pass.points)
      scorers.emplace_back(problem, point, pass.rotation_reference);
  }
  CandidateGraph Graph() const {
    std::vector<Layer> layers;
    std::vector<std::shared_ptr<PointVerdicts>> known;
    for (const PointScorer& scorer : scorers) {
      layers.push_back(MakeLayer(scorer, SeedsOf(CandidateTable::OfStep(scorer, DegToRad(4))), false));
      known.push_back(std::make_shared<PointVerdicts>());
    }
    const std::vector<Joints> steps(layers.size(), Joints::Constant(DegToRad(150)));
    return {checks, std::move(layers), steps, known};
  }
  /// A motion from one free side of the ball to the other: from node `from` of layer t to node `to`.
  std::optional<Sequence> Across() const {
    CandidateGraph graph = Graph();
    PassCheckers checkers(graph.checks());
    Sequence pair;
    pair.break_before.assign(graph.size(), false);
    const size_t t = 6;
    for (size_t from = 0; from < graph.layer(t).size(); ++from)
      for (const size_t away : {8, 14, 20}) {
        pair.nodes.assign(graph.size(), kNoNode);
        pair.nodes[t] = from, pair.nodes[t + 1] = from + away;
        if (from + away >= graph.layer(t + 1).size() ||
            graph.layer(t).LaneOf(from) != graph.layer(t + 1).LaneOf(from + away))
          continue;
        if (graph.IsFree(checkers, t, from) && graph.IsFree(checkers, t + 1, from + away) &&
            !graph.IsFree(checkers, t, *graph.TransitionOf(pair, t)))
          return pair;
      }
    return std::nullopt;
  }
};

TEST(CollisionPruner, BarsBesideAMotionWhatInterferesAlone) {
  const LongSteps f;
  const std::optional<Sequence> across = f.Across();
  ASSERT_TRUE(across);
  CandidateGraph graph = f.Graph();
  const BendLaw law(graph.checks(), f.scorers, 1e9);
  CollisionPruner pruner(graph, law);
  EXPECT_FALSE(pruner.Check(*across));
  const auto barred = [&] {
    size_t count = 0;
    for (const BlockedEdges& edges : graph.barred()) count += edges.size();
    return count;
  };
  ASSERT_EQ(barred(), 1u);
  pruner.BarBeside(*across);
  EXPECT_GT(barred(), 20u);
  EXPECT_GT(graph.barred()[5].size() + graph.barred()[7].size(), 0u) << "from the layers beside, too";
  Checker alone(f.world);
  for (size_t t = 0; t < graph.size(); ++t)
    for (const auto& [from, to] : graph.barred()[t]) {
      const Joints q = graph.layer(t).joints.At(from);
      const Joints end = q + (graph.layer(t + 1).joints.At(to) - q).unaryExpr(&WrapToPi);
      EXPECT_TRUE(CheckCut(alone, f.checks.carrier, q, end, 0.5)) << t << " " << from << " " << to;
      EXPECT_EQ(graph.VerdictOf(t, from), CandidateGraph::Verdict::kFree);
      EXPECT_EQ(graph.VerdictOf(t + 1, to), CandidateGraph::Verdict::kFree);
    }
}

}  // namespace
}  // namespace millpose
