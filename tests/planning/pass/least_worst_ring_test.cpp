// SPDX-License-Identifier: GPL-3.0-or-later
// Rings by their worst value first: bounds against exact searches, and the whole against every ring there is.
#include "planning/ladder/least_worst_ring.hpp"

#include "planning/ladder/returning.hpp"
#include "planning/ladder/worst_then_sum.hpp"
#include "tests/planning/pass/random_layers.hpp"
#include "tests/planning/pass/small_layers.hpp"

namespace millpose {
namespace {

TEST(LeastClosedBound, IsTheLeastWithWhichAnExactSearchCloses) {
  int closed = 0, none = 0, above = 0;
  for (int trial = 0; trial < 300; ++trial) {
    RandomStream stream(71, static_cast<uint64_t>(trial));
    std::vector<Layer> layers = RandomLayers(stream, 7, 90, 0.5);
    std::vector<BlockedEdges> blocked(layers.size());
    std::vector<uint64_t> versions(layers.size(), 0);
    for (int k = 0; k < 60; ++k) BlockSome(stream, layers, blocked, versions);
    if (!std::ranges::all_of(layers, &Layer::usable)) continue;
    LadderProblem problem{layers, Rule(40, 0.3), blocked, trial % 3 == 0, trial % 2 == 0, {}, {}};
    problem.rule.modulo_revolutions = trial % 5 != 0;
    const double bound = LeastClosedBound(problem);
    LadderProblem within = problem;
    within.most = bound;
    EXPECT_EQ(SearchClosed(within).has_value(), std::isfinite(bound));
    if (!std::isfinite(bound)) {
      ++none;
      continue;
    }
    ++closed;
    within.most = std::nextafter(bound, 0);
    EXPECT_FALSE(SearchClosed(within));
    const std::vector<double> values = PossibleBounds(problem, kInfinity);
    above += bound > values.front();
    problem.most = std::nextafter(bound, 0);
    EXPECT_EQ(LeastClosedBound(problem), kInfinity);
    std::vector<char> lifted(layers.size(), 0);
    lifted[2] = 1;
    problem.most = kInfinity;
    problem.break_before = lifted;
    EXPECT_EQ(LeastClosedBound(problem), kInfinity);
  }
  EXPECT_GT(closed, 30);
  EXPECT_GT(none, 30);
  EXPECT_GT(above, 20) << "more than the worst of the points' best values";
}

/// Nodes and steps that interfere, which searches only find out by asking.
struct Hidden {
  std::vector<std::vector<char>> nodes;
  std::vector<BlockedEdges> steps;

  Hidden(RandomStream& stream, const std::vector<Layer>& layers)
      : nodes(layers.size()), steps(layers.size()) {
    for (size_t t = 0; t < layers.size(); ++t) {
      const size_t next = layers[(t + 1) % layers.size()].size();
      for (size_t k = 0; k < layers[t].size(); ++k) {
        nodes[t].push_back(stream.Below(4) == 0);
        for (size_t to = 0; to < next; ++to)
          if (stream.Below(5) == 0) steps[t].insert({k, to});
      }
    }
  }
  bool IsFree(const std::vector<size_t>& ring) const {
    for (size_t t = 0; t < ring.size(); ++t)
      if (nodes[t][ring[t]] != 0 || steps[t].contains({ring[t], ring[(t + 1) % ring.size()]})) return false;
    return true;
  }
};

TEST(SearchLeastWorstRing, FindsTheLeastWorstOfAllThatAreFree) {
  int found_some = 0, none = 0, asked = 0;
  for (int trial = 0; trial < 400; ++trial) {
    RandomStream stream(72, static_cast<uint64_t>(trial));
    std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(3));
    const std::vector<Layer> whole = layers;
    const Hidden hidden(stream, layers);
    std::vector<BlockedEdges> blocked(layers.size());
    std::vector<uint64_t> versions(layers.size(), 0);
    LadderProblem problem{layers, SmallRule(), blocked, false, false, {}, {}};
    problem.rule.max_step.setConstant(DegToRad(90));
    problem.versions = versions;
    double expected = kInfinity;
    std::vector<size_t> nodes(layers.size(), 0);
    do {
      const Sequence ring{nodes, std::vector<bool>(nodes.size(), false), 0, true};
      if (hidden.IsFree(nodes) && std::isfinite(CostOf(problem, ring)))
        expected = std::min(expected, WorstOf(layers, ring));
    } while (NextChoice(layers, nodes));
    const auto search = [](const auto& find) { return find(); };
    const auto is_free = [&](const Sequence& ring, int) {
      EXPECT_TRUE(std::isfinite(CostOf(problem, ring)));
      EXPECT_NEAR(ring.cost, CostOf(problem, ring), 1e-12);
      bool free = true;
      for (size_t t = 0; t < layers.size(); ++t) {
        const std::pair step{ring.nodes[t], ring.nodes[(t + 1) % layers.size()]};
        if (hidden.nodes[t][ring.nodes[t]] != 0)
          layers[t].objective[ring.nodes[t]] = kInfinity;
        else if (hidden.steps[t].contains(step))
          blocked[t].insert(step);
        else
          continue;
        ++versions[t];
        free = false;
      }
      asked += !free;
      return free;
    };
    const std::optional<Sequence> found = SearchLeastWorstRing(problem, {search, is_free});
    ASSERT_EQ(found.has_value(), std::isfinite(expected)) << trial;
    ++(found ? found_some : none);
    if (!found) continue;
    EXPECT_TRUE(found->closed);
    EXPECT_TRUE(hidden.IsFree(found->nodes));
    EXPECT_LE(WorstOf(whole, *found), expected * (1 + kWorstTolerance)) << trial;
  }
  EXPECT_GT(found_some, 100);
  EXPECT_GT(none, 50);
  EXPECT_GT(asked, 300);
}

}  // namespace
}  // namespace millpose
