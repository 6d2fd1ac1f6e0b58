// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/candidate_graph.hpp"

#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

using Verdict = CandidateGraph::Verdict;

/// A row of points with a ball where the wrist would stand at its middle.
struct Fixture {
  PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-60, 60, 12);
  std::vector<PointScorer> scorers;
  World world{CellWithBallAt(
      problem, PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2}), 6, 60)};
  std::vector<std::shared_ptr<PointVerdicts>> known;

  Fixture() {
    for (const MillingPoint& point : pass.points) {
      scorers.emplace_back(problem, point, pass.rotation_reference);
      known.push_back(std::make_shared<PointVerdicts>());
    }
  }
  PassChecks Checks() const { return {world, {problem.arm, problem.X_WB, problem.X_FT}, 0.5, true, 2, {}}; }
  CandidateGraph Graph() const {
    std::vector<Layer> layers;
    for (const PointScorer& scorer : scorers)
      layers.push_back(MakeLayer(scorer, SeedsOf(CandidateTable::OfStep(scorer, DegToRad(4))), false));
    const std::vector<Joints> steps(layers.size(), Joints::Constant(DegToRad(10)));
    return {Checks(), std::move(layers), steps, known};
  }
};

/// The node nearest to another's rotation on its branch in the next layer, or `away` nodes beyond; kNoNode
/// where there is none.
size_t Beside(const CandidateGraph& graph, size_t t, size_t node, size_t away = 0) {
  const Layer &layer = graph.layer(t), &next = graph.layer(t + 1);
  const int branch = layer.BranchOf(node);
  const size_t begin = next.lane_begin[branch], end = next.lane_begin[branch + 1];
  size_t best = kNoNode;
  const auto off = [&](size_t k) { return std::abs(next.first[k] - layer.first[node]); };
  for (size_t k = begin; k < end; ++k)
    if (best == kNoNode || off(k) < off(best)) best = k;
  return best == kNoNode || best + away >= end ? kNoNode : best + away;
}

/// One sequence through free nodes of two layers, elsewhere nothing.
Sequence Pair(const CandidateGraph& graph, size_t t, size_t a, size_t b) {
  Sequence sequence;
  sequence.nodes.assign(graph.size(), kNoNode);
  sequence.break_before.assign(graph.size(), false);
  sequence.nodes[t] = a, sequence.nodes[t + 1] = b;
  return sequence;
}

TEST(CandidateGraph, VerdictsAreThoseOfACheckerAlone) {
  const Fixture f;
  CandidateGraph graph = f.Graph();
  std::vector<size_t> blocked(graph.size(), 0);
  graph.InParallel(graph.size(), [&](PassCheckers& checker, size_t t) {
    for (size_t k = 0; k < graph.layer(t).size(); ++k) {
      EXPECT_EQ(graph.VerdictOf(t, k), Verdict::kUnknown);
      const bool free = graph.IsFree(checker, t, k);
      EXPECT_EQ(free, !Checker(f.world).At(graph.layer(t).joints.At(k), Phase::kCutting)) << t << " " << k;
      EXPECT_EQ(std::isfinite(graph.layer(t).objective[k]), free);
      EXPECT_EQ(graph.PairOf(t, k) >= 0, !free);
      blocked[t] += !free;
    }
  });
  EXPECT_GT(blocked[6], 0u);
  EXPECT_LT(blocked[6], graph.layer(6).size());
  EXPECT_GT(graph.versions()[6], 0u);
}

TEST(CandidateGraph, WhatOneGraphLookedAtTheNextKnows) {
  const Fixture f;
  CandidateGraph first = f.Graph(), second = f.Graph();
  const auto look = [](CandidateGraph& graph) {
    graph.InParallel(graph.size() - 1, [&](PassCheckers& checker, size_t t) {
      for (size_t k = 0; k < graph.layer(t).size(); k += 7) {
        const size_t next = Beside(graph, t, k);
        if (!graph.IsFree(checker, t, k) || next == kNoNode) continue;
        graph.IsFree(checker, t, *graph.TransitionOf(Pair(graph, t, k, next), t));
      }
    });
  };
  look(first);
  EXPECT_GT(first.counts().poses, 100);
  look(second);
  EXPECT_EQ(second.counts().poses, 0);
  for (size_t t = 0; t < first.size(); ++t) {
    EXPECT_EQ(first.barred()[t], second.barred()[t]);
    for (size_t k = 0; k < first.layer(t).size(); ++k)
      EXPECT_EQ(first.VerdictOf(t, k), second.VerdictOf(t, k));
  }
}

TEST(CandidateGraph, PruningsAreOfOneGraphAlone) {
  const Fixture f;
  CandidateGraph first = f.Graph(), second = f.Graph();
  const double objective = first.layer(3).objective[5];
  first.TakeOut(3, 5);
  EXPECT_FALSE(std::isfinite(first.layer(3).objective[5]));
  EXPECT_EQ(first.nodes_pruned(), 1);
  EXPECT_EQ(second.layer(3).objective[5], objective);
  EXPECT_EQ(second.nodes_pruned(), 0);
  // What was taken out for another's sake comes back with what was known of it, where the path goes through.
  first.GiveBack(Pair(first, 3, 4, 4));
  EXPECT_EQ(first.layer(3).objective[5], objective);
  EXPECT_EQ(first.VerdictOf(3, 5), Verdict::kUnknown);
}

TEST(CandidateGraph, ATransitionIsBarredByWhatCheckCutFinds) {
  const Fixture f;
  CandidateGraph graph = f.Graph();
  PassCheckers checker(graph.checks());
  Checker alone(f.world);
  size_t looked = 0, barred = 0;
  const auto look = [&](size_t t, size_t k, size_t next) {
    if (next == kNoNode || !graph.IsFree(checker, t, k) || !graph.IsFree(checker, t + 1, next)) return;
    const CandidateGraph::Transition step = *graph.TransitionOf(Pair(graph, t, k, next), t);
    const uint64_t version = graph.versions()[t];
    const bool free = graph.IsFree(checker, t, step);
    EXPECT_EQ(free, !CheckCut(alone, f.Checks().carrier, step.q, step.q + step.step, 0.5)) << t << " " << k;
    EXPECT_EQ(graph.barred()[t].contains({k, next}), !free);
    EXPECT_EQ(graph.versions()[t] != version, !free);
    ++looked;
    barred += !free;
  };
  // Far steps lead through the ball from one free side of it to the other.
  for (size_t t = 5; t < 7; ++t)
    for (size_t k = 0; k < graph.layer(t).size(); ++k)
      for (const size_t away : {0, 12}) look(t, k, Beside(graph, t, k, away));
  EXPECT_GT(looked, 100u);
  EXPECT_GT(barred, 0u);
}

}  // namespace
}  // namespace millpose
