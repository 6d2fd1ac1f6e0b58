// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/ladder_search.hpp"

#include "base/units.hpp"
#include "planning/ladder/block_kernel.hpp"
#include "planning/ladder/returning.hpp"
#include "planning/ladder/table_layer.hpp"
#include "tests/planning/pass/random_layers.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

/// Layers of a row of panel points on a real arm.
std::vector<Layer> PanelLayers(const PoseProblem& problem, int count, double step,
                               bool all_revolutions = false, double spacing = 4) {
  std::vector<Layer> layers;
  for (int t = 0; t < count; ++t) {
    const MillingPoint point = PanelPoint(-0.5 * spacing * count + spacing * t, 60);
    const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
    layers.push_back(MakeLayer(scorer, SeedsOf(CandidateTable::OfStep(scorer, step)), all_revolutions));
  }
  return layers;
}

void ExpectSameNodes(const Layer& a, const Layer& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.lane_begin, b.lane_begin);
  EXPECT_EQ(a.joints.q, b.joints.q);
  EXPECT_EQ(a.objective, b.objective);
  EXPECT_EQ(a.freedoms, b.freedoms);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.base, b.base);
  EXPECT_EQ(a.genetic, b.genetic);
}

TEST(MakeLayer, OfATableIsThatOfASeedForEveryEntry) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(100, 60), Eigen::Vector3d::UnitZ());
  const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(3));
  for (const bool all_revolutions : {false, true}) {
    std::vector<NodeSeed> seeds = SeedsOf(table), others;
    const std::vector<NodeSeed> of_table = seeds;
    // Between two entries, as another, before the first and after the last of their branches, and a branch
    // without entries.
    for (size_t i = 0; i < of_table.size(); i += 7) {
      NodeSeed other = of_table[i];
      other.genetic = true;
      other.freedoms[0] += DegToRad(static_cast<double>(i % 3) - 1) + (i % 5 == 0 ? 4 : 0);
      if (i % 11 == 0) other.branch = 7 - other.branch;
      others.push_back(other);
    }
    others.push_back(of_table[1]);
    others.push_back(of_table[2]);
    others.back().candidate.obstacle = Infeasibility::kLimit;
    seeds.insert(seeds.end(), others.begin(), others.end());
    ExpectSameNodes(MakeLayer(scorer, table, others, all_revolutions),
                    MakeLayer(scorer, seeds, all_revolutions));
  }
}

TEST(FreedomsOf, AreThoseOfTheSeeds) {
  for (const PoseProblem& problem : {MakeProblem(Kr500R2830()), LeaningProblem()}) {
    const PointScorer scorer(problem, PanelPoint(100, 60), Eigen::Vector3d::UnitZ());
    const CandidateTable table = CandidateTable::OfSize(scorer, 200);
    const Layer of_seeds = MakeLayer(scorer, SeedsOf(table), false),
                of_table = MakeLayer(scorer, table, {}, false);
    ASSERT_EQ(of_table.size(), table.entries().size());
    size_t node = 0;
    for (int branch = 0; branch < 8; ++branch)
      for (const CandidateTable::Entry& entry : table.entries()) {
        if (entry.branch != branch) continue;
        EXPECT_EQ(FreedomsOf(of_table, node), table.Setting(entry.setting));
        EXPECT_EQ(FreedomsOf(of_seeds, node++), table.Setting(entry.setting));
      }
  }
}

struct Dense {
  int breaks;
  double cost;
  bool operator<(const Dense& other) const {
    return breaks != other.breaks ? breaks < other.breaks : cost < other.cost;
  }
};

double EdgeCost(const LadderProblem& problem, size_t from, size_t a, size_t to, size_t b) {
  const Layer &first = problem.layers[from], &second = problem.layers[to];
  if (first.BranchOf(a) != second.BranchOf(b)) return kInfinity;
  if (!problem.blocked.empty() && problem.blocked[from].contains({a, b})) return kInfinity;
  return StepCost(problem.rule, first.joints.At(a), second.joints.At(b));
}

/// The slow way: every edge looked at, breaks counted apart. `start`, when given, is the only first node.
std::vector<Dense> DenseRow(const LadderProblem& problem, size_t start = kNoNode, bool breaks = true) {
  std::vector<Dense> row;
  size_t previous = kNoNode;
  bool joined = true;
  for (size_t t = 0; t < problem.layers.size(); ++t) {
    const Layer& layer = problem.layers[t];
    if (!layer.usable()) {
      joined = false;
      continue;
    }
    std::vector<Dense> next(layer.size(), {1000000, kInfinity});
    for (size_t b = 0; b < layer.size(); ++b) {
      if (!std::isfinite(layer.objective[b])) continue;
      Dense best{1000000, kInfinity};
      if (previous == kNoNode) {
        if (start == kNoNode || b == start) best = {0, 0};
      } else {
        for (size_t a = 0; a < row.size(); ++a) {
          if (!std::isfinite(row[a].cost)) continue;
          if (breaks) best = std::min(best, Dense{row[a].breaks + 1, row[a].cost});
          const double edge = joined ? EdgeCost(problem, previous, a, t, b) : kInfinity;
          if (std::isfinite(edge)) best = std::min(best, Dense{row[a].breaks, row[a].cost + edge});
        }
      }
      next[b] = {best.breaks, best.cost + layer.objective[b]};
    }
    row = std::move(next);
    previous = t;
    joined = true;
  }
  return row;
}

Dense Measure(const LadderProblem& problem, const Sequence& sequence) {
  Dense dense{0, 0};
  size_t previous = kNoNode;
  for (size_t t = 0; t < sequence.nodes.size(); ++t) {
    EXPECT_EQ(sequence.nodes[t] == kNoNode, !problem.layers[t].usable()) << t;
    if (sequence.nodes[t] == kNoNode) continue;
    dense.cost += problem.layers[t].objective[sequence.nodes[t]];
    if (sequence.break_before[t]) {
      ++dense.breaks;
    } else if (previous != kNoNode) {
      EXPECT_EQ(previous + 1, t);
      dense.cost += EdgeCost(problem, previous, sequence.nodes[previous], t, sequence.nodes[t]);
    }
    previous = t;
  }
  return dense;
}

TEST(SearchOpen, EqualsTheDenseReferenceOnRandomLayers) {
  RandomStream stream(2, 0);
  int broken = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Layer> layers = RandomLayers(stream, 1 + stream.Below(9), 12, 0.5);
    std::vector<BlockedEdges> blocked(layers.size());
    for (size_t t = 0; t + 1 < layers.size(); ++t) {
      for (int k = 0; k < 10 && layers[t].size() && layers[t + 1].size(); ++k) {
        blocked[t].insert({stream.Below(static_cast<int>(layers[t].size())),
                           stream.Below(static_cast<int>(layers[t + 1].size()))});
      }
    }
    const LadderProblem problem{layers, Rule(60, 0.3), blocked, false, false, {}, {}};
    const Sequence sequence = SearchOpen(problem);
    const Dense found = Measure(problem, sequence);
    const std::vector<Dense> row = DenseRow(problem);
    if (row.empty()) continue;
    const Dense expected = *std::min_element(row.begin(), row.end());
    EXPECT_EQ(found.breaks, expected.breaks);
    EXPECT_NEAR(found.cost, expected.cost, 1e-12 * expected.cost);
    EXPECT_NEAR(sequence.cost, found.cost, 1e-12);
    broken += found.breaks > 0;
  }
  EXPECT_GT(broken, 50);
}

TEST(SearchClosed, EqualsTheDenseReferenceOnRandomLayers) {
  RandomStream stream(4, 0);
  int closed = 0, open = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Layer> layers = RandomLayers(stream, 2 + stream.Below(5), 14, 0.4);
    const LadderProblem problem{layers, Rule(60, 0.3), {}, false, false, {}, {}};
    double expected = kInfinity;
    const bool usable = std::all_of(layers.begin(), layers.end(), [](const Layer& l) { return l.usable(); });
    for (size_t start = 0; usable && start < layers[0].size(); ++start) {
      const std::vector<Dense> row = DenseRow(problem, start, false);
      for (size_t end = 0; end < row.size(); ++end) {
        expected = std::min(expected, row[end].cost + EdgeCost(problem, layers.size() - 1, end, 0, start));
      }
    }
    const std::optional<Sequence> found = SearchClosed(problem);
    EXPECT_EQ(found.has_value(), std::isfinite(expected));
    ++(found ? closed : open);
    if (!found) continue;
    EXPECT_NEAR(found->cost, expected, 1e-12 * expected);
    const double cycle = Measure(problem, *found).cost +
                         EdgeCost(problem, layers.size() - 1, found->nodes.back(), 0, found->nodes[0]);
    EXPECT_NEAR(cycle, expected, 1e-12 * expected);
    EXPECT_TRUE(found->closed);
    constexpr int kAll = std::numeric_limits<int>::max();
    EXPECT_FALSE(SearchClosed(problem, kAll, expected * (1 - 1e-6)));
    const std::optional<Sequence> below = SearchClosed(problem, kAll, expected * (1 + 1e-6));
    ASSERT_TRUE(below);
    EXPECT_NEAR(below->cost, expected, 1e-12 * expected);
  }
  EXPECT_GT(closed, 50);
  EXPECT_GT(open, 50);
}

TEST(AreReturning, EqualsTheDenseReferenceOnRandomLayers) {
  size_t returning = 0, lost = 0;
  for (int round = 0; round < 60; ++round) {
    RandomStream stream(31, static_cast<uint64_t>(round));
    std::vector<Layer> layers = RandomLayers(stream, 6, 150, 0.6);
    if (!std::all_of(layers.begin(), layers.end(), [](const Layer& l) { return l.usable(); })) continue;
    std::vector<BlockedEdges> blocked(layers.size());
    std::vector<std::vector<char>> counts;
    std::vector<Layer> counted = layers;
    for (size_t t = 0; t < layers.size(); ++t) {
      const int size = static_cast<int>(layers[t].size()),
                next = static_cast<int>(layers[(t + 1) % layers.size()].size());
      for (int k = 0; k < 300; ++k) blocked[t].insert({stream.Below(size), stream.Below(next)});
      counts.emplace_back(layers[t].size(), 1);
      for (int node = 0; node < size; ++node)
        if (stream.Below(3) == 0) counts[t][node] = 0, counted[t].objective[node] = kInfinity;
    }
    LadderProblem problem{layers, Rule(45), blocked, false, false, {}, {}};
    problem.first_layer = static_cast<size_t>(round) % layers.size();
    // The reference begins with the first layer.
    LadderProblem reference = problem;
    std::rotate(counted.begin(), counted.begin() + problem.first_layer, counted.end());
    std::vector<BlockedEdges> turned = blocked;
    std::rotate(turned.begin(), turned.begin() + problem.first_layer, turned.end());
    reference.layers = counted;
    reference.blocked = turned;
    std::vector<NodeRange> ranges;
    for (size_t node = 0; node < layers[problem.first_layer].size(); ++node)
      ranges.emplace_back(node, node + 1);
    const std::vector<char> found = AreReturning(problem, ranges, counts);
    for (size_t start = 0; start < ranges.size(); ++start) {
      bool expected = false;
      const std::vector<Dense> row = DenseRow(reference, start, false);
      // Where the last layer has no node that counts, the row is that of a layer before it.
      for (size_t end = 0; counted.back().usable() && end < row.size(); ++end)
        expected =
            expected || std::isfinite(row[end].cost + EdgeCost(reference, counted.size() - 1, end, 0, start));
      ASSERT_EQ(found[start] != 0, expected) << round << ' ' << start;
      ++(expected ? returning : lost);
    }
  }
  EXPECT_GT(returning, 200u);
  EXPECT_GT(lost, 200u);
}

TEST(SweepMemory, WhatSweepsKeepChangesNoBit) {
  int closed = 0, open = 0;
  for (int trial = 0; trial < 60; ++trial) {
    RandomStream stream(21, static_cast<uint64_t>(trial));
    const bool walls = trial % 2 == 0;
    std::vector<Layer> layers = RandomLayers(stream, 12, 60, 0.5);
    std::vector<BlockedEdges> blocked(layers.size());
    std::vector<uint64_t> versions(layers.size(), 0);
    SweepMemory memory;
    const LadderProblem anew{layers, Rule(60, 0.3), blocked, false, walls, {}, {}},
        keeping{layers, Rule(60, 0.3), blocked, false, walls, {}, {}, &memory, versions};
    for (int round = 0; round < 12; ++round) {
      const int sweeps = round % 3 == 2 ? std::numeric_limits<int>::max() : 3;
      const auto a = SearchClosed(anew, sweeps), b = SearchClosed(keeping, sweeps);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (a) ExpectSame(*a, *b);
      ++(a ? closed : open);
      if (round % 2) ExpectSame(SearchOpen(anew), SearchOpen(keeping));
      BlockSome(stream, layers, blocked, versions);
    }
  }
  EXPECT_GT(closed, 100);
  EXPECT_GT(open, 100);
}

TEST(SearchOpen, TheBandLosesNothingOnARealArm) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  for (const bool all_revolutions : {false, true}) {
    const std::vector<Layer> layers = PanelLayers(problem, 12, DegToRad(2), all_revolutions, 25);
    StepRule rule = Rule(4, 1e-3);
    rule.modulo_revolutions = !all_revolutions;
    const LadderProblem dense{layers, rule, {}, false, false, {}, {}},
        banded{layers, rule, {}, true, false, {}, {}};
    const Sequence a = SearchOpen(dense), b = SearchOpen(banded);
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.break_before, b.break_before);
    EXPECT_EQ(a.cost, b.cost);
    const std::vector<Dense> row = DenseRow(dense);
    EXPECT_NEAR(a.cost, std::min_element(row.begin(), row.end())->cost, 1e-15);
    // The law behind the band: within the joint step, rotations lie no farther apart than it says.
    const Eigen::AngleAxisd turn(layers[0].R_WT.transpose() * layers[1].R_WT);
    double farthest = 0;
    for (size_t i = 0; i < layers[0].size(); ++i) {
      for (size_t j = 0; j < layers[1].size(); ++j) {
        if (!std::isfinite(EdgeCost(dense, 0, i, 1, j))) continue;
        farthest = std::max(farthest, std::abs(WrapToPi(layers[0].first[i] - layers[1].first[j])));
      }
    }
    EXPECT_LE(farthest, BandWidth(rule, turn.angle()));
    EXPECT_GT(farthest, DegToRad(1.9));
  }
}

TEST(RelaxFrom, EveryNodeOfABlockCounts) {
  RandomStream stream(9, 0);
  JointRows nodes;
  std::vector<double> costs;
  for (int k = 0; k < 37; ++k) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = stream.Uniform(-7, 7);
    nodes.Add(q);
    costs.push_back(stream.Uniform(0, 1));
  }
  nodes.Finish();
  CostRow row(costs);
  std::fill(row.costs.begin() + 37, row.costs.end(), -1e9);  // beyond the end nothing may be taken
  StepRule rule = Rule(170, 0.01);
  for (const bool modulo : {true, false}) {
    rule.modulo_revolutions = modulo;
    for (size_t first = 0; first < 37; ++first) {
      for (size_t last = first; last <= 37; ++last) {
        const Joints to = Joints::Constant(0.1 * static_cast<double>(last));
        BestPredecessor found, known, expected;
        RelaxFrom(rule, nodes, row, first, last, to, kInfinity, found);
        for (size_t k = first; k < last; ++k) {
          const double cost = row.costs[k] + StepCost(rule, nodes.At(k), to);
          if (cost < expected.cost) expected = {cost, k};
        }
        EXPECT_EQ(found.cost, expected.cost);
        EXPECT_EQ(found.node, expected.node);
        // Knowing a bound passes over more and changes nothing.
        RelaxFrom(rule, nodes, row, first, last, to, expected.cost, known);
        EXPECT_EQ(known.cost, expected.cost);
        EXPECT_EQ(known.node, expected.node);
      }
    }
  }
}

/// Nodes near each other, as on a layer, with a few far off.
JointRows RowOfNodes(RandomStream& stream, size_t count) {
  JointRows nodes;
  Joints q = Joints::Constant(2.9);
  for (size_t k = 0; k < count; ++k) {
    for (int j = 0; j < 6; ++j) q[j] += stream.Uniform(-0.05, 0.05);
    nodes.Add(k % 17 == 16 ? Joints(q + Joints::Constant(stream.Uniform(-7, 7))) : q);
  }
  nodes.Finish();
  return nodes;
}

TEST(RelaxBlock, FindsForEveryNodeWhatRelaxFromFinds) {
  RandomStream stream(11, 0);
  size_t found = 0, none = 0;
  for (int round = 0; round < 400; ++round) {
    const JointRows from = RowOfNodes(stream, 150), to = RowOfNodes(stream, 21);
    std::vector<double> costs(150);
    for (double& cost : costs) cost = std::floor(stream.Uniform(0, 8)) / 8;  // ties
    const CostRow row(costs);
    StepRule rule = Rule(stream.Uniform(1, 40), round % 3 == 0 ? 0 : stream.Uniform(0, 2));
    rule.modulo_revolutions = round % 2 == 0;
    for (size_t begin = 0; begin < 21; begin += kBlock) {
      TargetBlock block;
      block.nodes = &to;
      block.begin = begin;
      for (size_t l = 0; l < kBlock && begin + l < 21; ++l) {
        if (stream.Uniform(0, 1) < 0.8) block.wanted |= 1u << l;
        block.first[l] = static_cast<size_t>(stream.Uniform(0, 150));
        block.last[l] = block.first[l] + static_cast<size_t>(stream.Uniform(0, 151.0 - block.first[l]));
      }
      const TargetBlock one_part = block;
      RelaxBlock(rule, from, row, static_cast<size_t>(stream.Uniform(0, 150)), block);
      // The other part of a band: what it holds that is no better leaves the best as it is.
      for (size_t l = 0; l < kBlock; ++l) block.first[l] = one_part.last[l], block.last[l] = 150;
      RelaxBlock(rule, from, row, static_cast<size_t>(stream.Uniform(0, 150)), block);
      for (size_t l = 0; l < kBlock; ++l) {
        if ((block.wanted >> l & 1u) == 0) continue;
        BestPredecessor expected;
        const Joints at = to.At(begin + l);
        for (const TargetBlock& part : {one_part, block})
          RelaxFrom(rule, from, row, part.first[l], part.last[l], at, kInfinity, expected);
        ASSERT_EQ(block.best[l].cost, expected.cost) << round;
        ++(std::isfinite(expected.cost) ? found : none);
        if (std::isfinite(expected.cost)) {
          ASSERT_EQ(block.best[l].node, expected.node) << round;
        }
      }
    }
  }
  EXPECT_GT(found, 1000u);
  EXPECT_GT(none, 1000u);
}

TEST(WrapToPi, TakesWholeTurnsAway) {
  EXPECT_NEAR(WrapToPi(DegToRad(350)), DegToRad(-10), 1e-15);
  EXPECT_NEAR(WrapToPi(DegToRad(-710)), DegToRad(10), 1e-15);
  EXPECT_EQ(WrapToPi(0.25), 0.25);
}

}  // namespace
}  // namespace millpose
