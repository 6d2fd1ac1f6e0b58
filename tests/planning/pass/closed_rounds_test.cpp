// SPDX-License-Identifier: GPL-3.0-or-later
// Closed sequences over layers of which ever more is pruned, against exact searches.
#include "planning/ladder/closed_rounds.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "tests/planning/pass/small_layers.hpp"

namespace millpose {
namespace {

/// The cost of the best closed sequence through one node of the first layer.
double BestThrough(std::vector<Layer> layers, size_t node, const LadderProblem& problem) {
  for (size_t k = 0; k < layers[0].size(); ++k)
    if (k != node) layers[0].objective[k] = kInfinity;
  LadderProblem alone = problem;
  alone.layers = layers;
  alone.versions = {};
  const std::optional<Sequence> best = SearchClosed(alone);
  return best ? best->cost : kInfinity;
}

TEST(ClosedRounds, FindTheBestThroughTheNodeThatTheyStartedFrom) {
  RandomStream stream(41, 0);
  int went_on = 0, moved = 0, better = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(4));
    std::vector<uint64_t> versions(layers.size(), 0);
    LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    problem.rule.max_step.setConstant(DegToRad(120));
    problem.versions = versions;
    ClosedRounds rounds;
    std::optional<Sequence> found = rounds.Search(problem, 3);
    ASSERT_EQ(!found, !SearchClosed(problem, 3));
    while (found) {
      const size_t start = found->nodes[0];
      const double cost = CostOf(problem, *found);
      EXPECT_NEAR(found->cost, cost, 1e-12);
      EXPECT_TRUE(found->closed);
      const size_t t = static_cast<size_t>(stream.Below(static_cast<int>(layers.size())));
      layers[t].objective[found->nodes[t]] = kInfinity;
      ++versions[t];
      const double best = BestThrough(layers, start, problem);
      found = rounds.Search(problem, 3);
      if (std::isfinite(best)) {
        ASSERT_TRUE(found);
        EXPECT_LE(found->cost, best + 1e-12);
        if (found->nodes[0] == start) {
          EXPECT_NEAR(found->cost, best, 1e-12);
          ++went_on;
        } else {
          EXPECT_LT(found->cost, best);
          ++better;
        }
      } else if (found) {
        EXPECT_NE(found->nodes[0], start);
        ++moved;
      }
    }
  }
  EXPECT_GT(went_on, 100);
  EXPECT_GT(moved, 20);
  EXPECT_GT(better, 10);
}

}  // namespace
}  // namespace millpose
