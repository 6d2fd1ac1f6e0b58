// SPDX-License-Identifier: GPL-3.0-or-later
// Against every sequence there is, on graphs so small that all can be looked at.
#include "planning/ladder/worst_then_sum.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "tests/planning/pass/small_layers.hpp"

namespace millpose {
namespace {

struct Value {
  int breaks = 1000;
  double worst = kInfinity, sum = kInfinity;
};

/// What a choice of nodes gives; `closed` with the step back to the first.
Value Measure(const LadderProblem& problem, const std::vector<size_t>& nodes, bool closed) {
  Value value{0, 0, 0};
  for (size_t t = 0; t < nodes.size(); ++t) {
    const Layer& layer = problem.layers[t];
    value.worst = std::max(value.worst, layer.objective[nodes[t]]);
    value.sum += layer.objective[nodes[t]];
    const size_t next = (t + 1) % nodes.size();
    if (next == 0 && !closed) break;
    const double step =
        StepCost(problem.rule, layer.joints.At(nodes[t]), problem.layers[next].joints.At(nodes[next]));
    if (std::isfinite(step)) value.sum += step;
    value.breaks += !std::isfinite(step);
  }
  return value;
}

/// The best of all sequences: fewest breaks, least worst, then least sum.
Value Best(const LadderProblem& problem, bool closed) {
  std::vector<Value> all;
  std::vector<size_t> nodes(problem.layers.size(), 0);
  do {
    all.push_back(Measure(problem, nodes, closed));
  } while (NextChoice(problem.layers, nodes));
  Value best;
  for (const Value& value : all)
    if (std::tie(value.breaks, value.worst) < std::tie(best.breaks, best.worst)) best = value;
  for (const Value& value : all)
    if (value.breaks == best.breaks && value.worst <= best.worst * (1 + kWorstTolerance))
      best.sum = std::min(best.sum, value.sum);
  return best;
}

TEST(WorstThenSum, OpenIsTheBestOfAllSequences) {
  RandomStream stream(21, 0);
  int broken = 0, traded = 0;
  for (int round = 0; round < 300; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 2 + stream.Below(4));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    const Value expected = Best(problem, false);
    WorstThenSum search;
    const Sequence found = search.Open(problem);
    const Value value = Measure(problem, found.nodes, false);
    EXPECT_EQ(value.breaks, expected.breaks);
    EXPECT_EQ(search.bound(), expected.worst);
    EXPECT_LE(value.worst, expected.worst * (1 + kWorstTolerance));
    EXPECT_NEAR(value.sum, expected.sum, 1e-12);
    broken += expected.breaks > 0;
    traded += SearchOpen(problem).cost < found.cost - 1e-9;
  }
  EXPECT_GT(broken, 30);
  EXPECT_GT(traded, 10) << "the sum alone takes worse points";
}

TEST(WorstThenSum, ClosedIsTheBestOfAllCycles) {
  RandomStream stream(22, 0);
  int closed = 0;
  for (int round = 0; round < 300; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(2));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    const Value expected = Best(problem, true);
    WorstThenSum search;
    const std::optional<Sequence> found = search.Closed(problem);
    ASSERT_EQ(found.has_value(), expected.breaks == 0);
    if (!found) continue;
    ++closed;
    const Value value = Measure(problem, found->nodes, true);
    EXPECT_EQ(value.breaks, 0);
    EXPECT_EQ(search.bound(), expected.worst);
    EXPECT_NEAR(value.sum, expected.sum, 1e-12);
  }
  EXPECT_GT(closed, 50);
}

TEST(WorstThenSum, KeepsItsBoundWhileNodesArePruned) {
  RandomStream stream(23, 0);
  for (int round = 0; round < 100; ++round) {
    std::vector<Layer> layers = SmallLayers(stream, 4);
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    WorstThenSum kept;
    for (int strike = 0; strike < 6; ++strike) {
      const Sequence found = kept.Open(problem);
      WorstThenSum anew;
      const Sequence expected = anew.Open(problem);
      EXPECT_EQ(kept.bound(), anew.bound());
      EXPECT_EQ(found.nodes, expected.nodes);
      // One node of the answer, unless it is its layer's last.
      const auto t = static_cast<size_t>(stream.Below(4));
      if (found.nodes[t] == kNoNode) continue;
      const double was = layers[t].objective[found.nodes[t]];
      layers[t].objective[found.nodes[t]] = kInfinity;
      if (!layers[t].usable()) layers[t].objective[found.nodes[t]] = was;
    }
  }
}

}  // namespace
}  // namespace millpose
