// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps that leave out what costs too much, against those that look at everything.
#include "base/units.hpp"
#include "planning/ladder/first_node.hpp"
#include "planning/ladder/sweep.hpp"
#include "tests/planning/pass/random_layers.hpp"

namespace millpose {
namespace {

TEST(LayerSteps, FindWhatCostsLessThanItMay) {
  int kept = 0, above = 0;
  for (int trial = 0; trial < 80; ++trial) {
    RandomStream stream(61, static_cast<uint64_t>(trial));
    const std::vector<Layer> layers = RandomLayers(stream, 2, 80, 0.5);
    std::vector<double> costs(layers[0].size());
    for (double& cost : costs) cost = stream.Uniform(0, 1);
    BlockedEdges blocked;
    for (int k = 0; k < 200 && layers[0].size() > 0 && layers[1].size() > 0; ++k)
      blocked.insert({stream.Below(static_cast<int>(layers[0].size())),
                      stream.Below(static_cast<int>(layers[1].size()))});
    const LayerSteps::Law law{Rule(60, 0.3), kInfinity, trial % 2 == 0, &blocked};
    std::vector<char> wanted(layers[1].size());
    for (char& want : wanted) want = stream.Below(trial % 4 + 1) == 0;
    std::vector<BestPredecessor> all(wanted.size()), below(wanted.size());
    for (BestPredecessor& by : below) by.cost = stream.Uniform(0, 1.5);
    const std::vector<BestPredecessor> bounds = below;
    const CostRow row(costs);
    LayerSteps(layers[0], layers[1], law).Relax(row, wanted, all);
    LayerSteps(layers[0], layers[1], law).Relax(row, wanted, below);
    for (size_t node = 0; node < wanted.size(); ++node) {
      if (wanted[node] == 0) continue;
      const BestPredecessor expected = all[node].cost < bounds[node].cost ? all[node] : BestPredecessor{};
      EXPECT_EQ(below[node].cost, expected.cost);
      EXPECT_EQ(below[node].node, expected.node);
      if (std::isfinite(all[node].cost)) ++(std::isfinite(expected.cost) ? kept : above);
    }
  }
  EXPECT_GT(kept, 300);
  EXPECT_GT(above, 100);
}

/// Branch and bound by sweeps that leave out nothing.
std::optional<Sequence> SearchSlowly(const LadderProblem& problem, int max_sweeps) {
  const auto round = [&](size_t first, size_t last) -> std::optional<Round> {
    Sweep sweep(problem, kInfinity);
    SweepRows rows;
    if (!sweep.Forward(rows, first, last, false)) return std::nullopt;
    const Sweep::Closing closing = sweep.Close(first, last);
    if (!std::isfinite(closing.by.cost)) return std::nullopt;
    return Round{closing.by.cost, closing.into, sweep.Trace(closing.by.node)};
  };
  return BranchOverFirst(problem.layers[0].base, round, max_sweeps);
}

TEST(SearchClosed, QuicklyFindsWhatSweepsWithoutALimitFind) {
  int closed = 0, none = 0;
  for (int trial = 0; trial < 150; ++trial) {
    RandomStream stream(62, static_cast<uint64_t>(trial));
    std::vector<Layer> layers = RandomLayers(stream, 8, 60, 0.6);
    std::vector<BlockedEdges> blocked(layers.size());
    std::vector<uint64_t> versions(layers.size(), 0);
    SweepMemory memory;
    LadderProblem problem{layers, Rule(60, 0.3), blocked, false, trial % 2 == 0, {}, {}, &memory, versions};
    if (trial % 3 == 0) problem.most = 1.8;
    for (int round = 0; round < 6; ++round) {
      if (!std::ranges::all_of(layers, &Layer::usable)) break;
      const std::optional<Sequence> expected = SearchSlowly(problem, 1 + round),
                                    found = SearchClosed(problem, 1 + round);
      ASSERT_EQ(found.has_value(), expected.has_value());
      if (found) ExpectSame(*found, *expected);
      ++(found ? closed : none);
      BlockSome(stream, layers, blocked, versions);
    }
  }
  EXPECT_GT(closed, 200);
  EXPECT_GT(none, 20);
}

TEST(LeastToGo, IsTheSameWhateverWasKept) {
  int differs = 0;
  for (int trial = 0; trial < 60; ++trial) {
    RandomStream stream(63, static_cast<uint64_t>(trial));
    const std::vector<Layer> whole = RandomLayers(stream, 8, 60, 0.6);
    std::vector<Layer> layers = whole;
    std::vector<uint64_t> versions(layers.size(), 0);
    LadderProblem problem{layers, Rule(60, 0.3), {}, false, false, {}, {}};
    problem.versions = versions;
    BackwardRows kept;
    for (int round = 0; round < 8; ++round) {
      BackwardRows anew;
      const ToGo before = kept.to_go;
      EXPECT_EQ(LeastToGo(problem, {}, kept), LeastToGo(problem, {}, anew));
      differs += round > 0 && before != kept.to_go;
      std::vector<BlockedEdges> blocked(layers.size());
      if (round % 3 != 2) {
        BlockSome(stream, layers, blocked, versions);
        continue;
      }
      const auto t = static_cast<size_t>(stream.Below(static_cast<int>(layers.size())));
      layers[t].objective = whole[t].objective;  // given back
      ++versions[t];
    }
  }
  EXPECT_GT(differs, 100);
}

}  // namespace
}  // namespace millpose
