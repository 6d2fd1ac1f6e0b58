// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/ladder_bound.hpp"

#include "planning/ladder/worst_then_sum.hpp"
#include "tests/planning/pass/pass_problem.hpp"
#include "tests/planning/pass/small_layers.hpp"

namespace millpose {
namespace {

TEST(LadderBound, IsTheCostOfABestSequence) {
  RandomStream stream(31, 0);
  int broken = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 2 + stream.Below(5));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    WorstThenSum search;
    const Sequence best = search.Open(problem);
    const LadderBound bound = BoundLadder(problem, best, true);
    EXPECT_NEAR(bound.cost_bound, bound.cost, 1e-12);
    EXPECT_EQ(bound.worst_bound, bound.worst);
    broken += std::count(best.break_before.begin(), best.break_before.end(), true) > 0;
  }
  EXPECT_GT(broken, 20);
}

// Any other sequence, lifted at the same places, costs no less than the bound.
TEST(LadderBound, NoSequenceIsCheaper) {
  RandomStream stream(32, 0);
  int tight = 0, count = 0;
  for (int round = 0; round < 300; ++round) {
    const bool closed = round % 3 == 0;
    const std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(3));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    std::optional<Sequence> any;
    if (closed) any = SearchClosed(problem);
    if (!any) any = SearchOpen(problem);
    // A worse one that is as continuous: other nodes where they can be had.
    Sequence worse = *any;
    for (size_t t = 0; t < layers.size(); ++t) {
      for (size_t node = 0; node < layers[t].size(); ++node) {
        Sequence other = worse;
        other.nodes[t] = node;
        const double cost = CostOf(problem, other);
        if (std::isfinite(cost) && cost > worse.cost) worse = other, worse.cost = cost;
      }
    }
    const LadderBound bound = BoundLadder(problem, worse, false);
    EXPECT_EQ(bound.cost, worse.cost);
    EXPECT_LE(bound.cost_bound, any->cost + 1e-12);
    EXPECT_EQ(bound.worst_bound, 0);
    ++count;
    tight += bound.cost_bound > any->cost - 1e-9;
  }
  EXPECT_GT(tight, count / 2) << "a bound of nothing holds too";
}

// What searches keep of their sweeps, with walls, makes no difference; nor does it whether the best of all is
// known to be that.
TEST(LadderBound, IsTheSameOverEarlierSweeps) {
  RandomStream stream(33, 0);
  int walled = 0, best = 0;
  for (int round = 0; round < 1000; ++round) {
    std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(4));
    std::vector<uint64_t> versions(layers.size(), 0);
    SweepMemory memory;
    LadderProblem problem{layers, SmallRule(), {}, true, true, {}, {}};
    problem.rule.max_step.setConstant(DegToRad(100));
    problem.memory = &memory;
    problem.versions = versions;
    const bool worst_first = stream.Below(2) > 0;
    WorstThenSum search;
    const auto found = [&] { return worst_first ? search.Open(problem) : SearchOpen(problem); };
    Sequence sequence = found();
    const auto expect_slow = [&](const LadderBound& fast) {
      LadderProblem alone = problem;
      alone.memory = nullptr;
      const LadderBound slow = BoundLadder(alone, sequence, worst_first);
      EXPECT_EQ(fast.cost_bound, slow.cost_bound);
      EXPECT_EQ(fast.worst_bound, slow.worst_bound);
      return slow;
    };
    if (Breaks(sequence) == 0) {
      expect_slow(BoundOfBest(layers, sequence, worst_first));
      ++best;
    }
    for (size_t t = 0; t < layers.size(); ++t) {  // walls on both sides of a node
      if (layers[t].size() < 5 || stream.Below(2) > 0) continue;
      layers[t].objective[1] = layers[t].objective[3] = std::numeric_limits<double>::infinity();
      ++versions[t];
    }
    sequence = found();
    for (int k = 0; k < 2; ++k) {  // nodes of the answer are pruned, and it is searched again
      const size_t t = static_cast<size_t>(stream.Below(static_cast<int>(layers.size())));
      if (sequence.nodes[t] == kNoNode) continue;
      layers[t].objective[sequence.nodes[t]] = std::numeric_limits<double>::infinity();
      ++versions[t];
      sequence = found();
    }
    const LadderBound slow = expect_slow(BoundLadder(problem, sequence, worst_first));
    walled += slow.cost_bound < slow.cost - 1e-9;
  }
  EXPECT_GT(best, 50);
  EXPECT_GT(walled, 10) << "walls that bar nothing test nothing";
}

TEST(LadderBound, OfAPassRoundAnObstacle) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Pass pass = Row(-60, 60, 24);
  const PassResult before = PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2});
  for (const PlannedPoint& point : before.points) {
    EXPECT_LE(point.free_optimum, std::min(point.unsmoothed, point.objective));
    EXPECT_NEAR(point.free_optimum, point.own_optimum, 1e-4 * point.own_optimum) << "nothing is met";
  }
  EXPECT_NEAR(before.bound.cost, before.bound.cost_bound, 1e-9 * before.bound.cost);

  const World world(CellWithBallAt(problem, before, 12, 30));
  PathOptions options = Options();
  options.worst_first = true;
  const PassResult result = PlanPass(problem, world, {pass}, options, {.threads = 2});
  EXPECT_GT(result.bound.cost_bound, 0);
  EXPECT_LE(result.bound.cost_bound, result.bound.cost);
  EXPECT_GT(result.bound.worst_bound, 0);
  EXPECT_LE(result.bound.worst_bound, result.bound.worst);
  EXPECT_LT(result.bound.worst / result.bound.worst_bound, 1.02);
  // No candidate that is better than the best free one is free.
  Checker checker(world);
  int barred = 0;
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    ASSERT_EQ(point.skip, Infeasibility::kNone);
    EXPECT_LE(point.free_optimum, std::min(point.unsmoothed, point.objective));
    barred += point.free_optimum > 1.0001 * point.own_optimum;
    const PointScorer scorer(problem, pass.points[t], pass.rotation_reference);
    for (const NodeSeed& seed : SeedsOf(CandidateTable::OfStep(scorer, options.rotation_step))) {
      if (seed.candidate.objective >= point.free_optimum) continue;
      EXPECT_TRUE(checker.Blocked(seed.candidate.q, Phase::kCutting)) << t << " at " << seed.freedoms[0];
    }
  }
  EXPECT_GT(barred, 0);
}

}  // namespace
}  // namespace millpose
