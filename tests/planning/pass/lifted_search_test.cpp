// SPDX-License-Identifier: GPL-3.0-or-later
// Against every sequence and every set of lifts there is, and rings against all starts.
#include "planning/ladder/lifted_search.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "planning/ladder/worst_then_sum.hpp"
#include "tests/planning/pass/small_layers.hpp"

namespace millpose {
namespace {

/// The best value with at most `most` lifts, by looking at all: the least worst, then the least cost, or the
/// least cost alone. `closed`: round, with the step from the last layer to the first; the tool may be lifted
/// there as well.
SequenceValue Enumerate(const LadderProblem& problem, size_t most, bool worst_first, bool closed,
                        const std::vector<char>& may, const std::vector<char>& must = {}) {
  const size_t count = problem.layers.size();
  SequenceValue best{kInfinity, kInfinity};
  for (const bool for_worst : {true, false}) {
    if (for_worst && !worst_first) continue;
    std::vector<size_t> nodes(count, 0);
    do {
      SequenceValue value;
      std::vector<double> steps;
      for (size_t t = 0; t < count; ++t) {
        const Layer& layer = problem.layers[t];
        value.worst = std::max(value.worst, layer.objective[nodes[t]]);
        value.cost += layer.objective[nodes[t]];
        const size_t next = (t + 1) % count;
        if (next == 0 && !closed) break;
        if (!must.empty() && must[next]) continue;
        steps.push_back(
            StepCost(problem.rule, layer.joints.At(nodes[t]), problem.layers[next].joints.At(nodes[next])));
        if (!may.empty() && !may[next]) value.cost += steps.back(), steps.pop_back();
      }
      std::ranges::sort(steps);  // the dearest are lifted over
      for (size_t k = 0; k + most < steps.size(); ++k) value.cost += steps[k];
      if (!std::isfinite(value.cost)) continue;
      if (for_worst) {
        best.worst = std::min(best.worst, value.worst);
      } else if (!worst_first || value.worst <= best.worst * (1 + kWorstTolerance)) {
        best.cost = std::min(best.cost, value.cost);
      }
    } while (NextChoice(problem.layers, nodes));
  }
  return best;
}

SequenceValue ValueOf(const LadderProblem& problem, const Sequence& sequence) {
  return {WorstOf(problem.layers, sequence), sequence.cost};
}

TEST(LiftedSearch, OpenIsTheBestOfAllSequencesWithSoManyLifts) {
  RandomStream stream(31, 0);
  int looked = 0, gained = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(4));
    std::vector<char> may(layers.size(), 1), must(layers.size(), 0);
    if (round % 3 == 1) may[1] = 0;
    if (round % 3 == 2) must[2] = 1;
    LadderProblem problem{layers, SmallRule(), {}, false, false, {}, must};
    for (const bool worst_first : {false, true}) {
      const SequenceValue without = Enumerate(problem, 0, worst_first, false, may, must);
      if (!std::isfinite(without.cost)) continue;  // must be lifted somewhere else: not asked here
      for (size_t most = 0; most <= kMostLifts; ++most) {
        const SequenceValue expected = Enumerate(problem, most, worst_first, false, may, must);
        LiftedSearch search({most, 0, worst_first});
        const Sequence found = search.Open(problem, may);
        EXPECT_NEAR(found.cost, expected.cost, 1e-12);
        if (worst_first) {
          EXPECT_LE(WorstOf(layers, found), expected.worst * (1 + kWorstTolerance));
        }
        EXPECT_NEAR(CostOf(problem, found), found.cost, 1e-12);
        std::vector<size_t> lifts = LiftsOf(found);
        EXPECT_LE(lifts.size(), most + static_cast<size_t>(std::ranges::count(must, 1)));
        for (const size_t t : lifts) EXPECT_TRUE(may[t] || must[t]);
        ++looked;
        gained += most > 0 && expected.cost < without.cost - 1e-9;
      }
    }
  }
  EXPECT_GT(looked, 400);
  EXPECT_GT(gained, 100);
}

TEST(LiftedSearch, ALiftIsMadeWhereItGainsMoreThanItsPrice) {
  RandomStream stream(32, 0);
  std::array<int, kMostLifts + 1> times{};
  for (int round = 0; round < 300; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 4 + stream.Below(3));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    const double gain = stream.Uniform(0, 0.2);
    const bool worst_first = round % 2 == 1;
    std::vector<double> values;
    for (size_t lifts = 0; lifts <= kMostLifts; ++lifts) {
      const SequenceValue value = Enumerate(problem, lifts, worst_first, false, {});
      values.push_back(worst_first ? value.worst : value.cost);
    }
    if (!std::isfinite(values[0])) continue;
    LiftedSearch search({kMostLifts, gain, worst_first});
    const Sequence found = search.Open(problem);
    const size_t lifts = LiftsOf(found).size();
    const double own = worst_first ? WorstOf(layers, found) : found.cost;
    for (size_t other = 0; other <= kMostLifts; ++other) {
      const double here = own + static_cast<double>(worst_first ? 0 : lifts) * gain * values[0];
      const double there = values[other] + static_cast<double>(other) * gain * values[0];
      EXPECT_LE(here, there * (1 + 1e-6)) << "rather " << other << " lifts than " << lifts;
    }
    ++times[lifts];
  }
  for (const int count : times) EXPECT_GT(count, 5);
}

TEST(LiftedSearch, RoundIsTheBestOfAllStarts) {
  RandomStream stream(33, 0);
  int looked = 0, elsewhere = 0;
  for (int round = 0; round < 300; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(4));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    for (const bool worst_first : {false, true}) {
      // The open problem from every start.
      SequenceValue expected{kInfinity, kInfinity}, first;
      for (size_t start = 0; start < layers.size(); ++start) {
        std::vector<Layer> turned = layers;
        std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(start), turned.end());
        const LadderProblem from{turned, SmallRule(), {}, false, false, {}, {}};
        WorstThenSum search;
        const Sequence open = worst_first ? search.Open(from) : SearchOpen(from);
        if (!LiftsOf(open).empty()) continue;
        const SequenceValue value = ValueOf(from, open);
        const bool better = worst_first && value.worst != expected.worst ? value.worst < expected.worst
                                                                         : value.cost < expected.cost;
        if (better) expected = value;
        if (start == 0) first = value;
      }
      if (!std::isfinite(expected.cost)) continue;
      ++looked;
      LiftedSearch search({0, 0, worst_first});
      const std::optional<Sequence> found = search.Round(problem);
      ASSERT_TRUE(found.has_value());
      EXPECT_LE(LiftsOf(*found).size(), 1);
      EXPECT_NEAR(found->cost, expected.cost, 1e-12);
      EXPECT_NEAR(CostOf(problem, *found), found->cost, 1e-12);
      if (worst_first) {
        EXPECT_EQ(WorstOf(layers, *found), expected.worst);
      }
      elsewhere += expected.cost < first.cost;
    }
  }
  EXPECT_GT(looked, 200);
  EXPECT_GT(elsewhere, 100);
}

TEST(LiftedSearch, RoundWithLiftsIsTheBestOfAll) {
  RandomStream stream(34, 0);
  int looked = 0;
  for (int round = 0; round < 100; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 3 + stream.Below(3));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    for (const bool worst_first : {false, true}) {
      if (!std::isfinite(Enumerate(problem, 1, worst_first, true, {}).cost)) continue;
      ++looked;
      const SequenceValue expected = Enumerate(problem, 3, worst_first, true, {});
      LiftedSearch search({2, 0, worst_first});
      const std::optional<Sequence> found = search.Round(problem);
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->cost, expected.cost, 1e-12);
    }
  }
  EXPECT_GT(looked, 50);
}

TEST(LiftedSearch, AnEndThatRunsOnIsCounted) {
  RandomStream stream(36, 0);
  int looked = 0, elsewhere = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Layer> layers = SmallLayers(stream, 4 + stream.Below(2));
    const LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    const double without = Enumerate(problem, 0, false, false, {}).cost;
    if (!std::isfinite(without)) continue;
    ++looked;
    // Each sequence with each place of one lift, whose end runs on over one point at the least cost.
    double expected = without, place = without;
    std::vector<size_t> nodes(layers.size(), 0);
    do {
      for (size_t lift = 1; lift < layers.size(); ++lift) {
        double cost = 0, on = kInfinity;
        const Joints end = layers[lift - 1].joints.At(nodes[lift - 1]);
        for (size_t t = 0; t < layers.size(); ++t) {
          cost += layers[t].objective[nodes[t]];
          if (t > 0 && t != lift)
            cost +=
                StepCost(problem.rule, layers[t - 1].joints.At(nodes[t - 1]), layers[t].joints.At(nodes[t]));
        }
        for (size_t k = 0; k < layers[lift].size(); ++k)
          on = std::min(on,
                        layers[lift].objective[k] + StepCost(problem.rule, end, layers[lift].joints.At(k)));
        place = std::min(place, cost);
        // What is cut already counts with what it costs more than it must.
        expected = std::min(expected, cost + on - *std::ranges::min_element(layers[lift].objective));
      }
    } while (NextChoice(layers, nodes));
    LiftedSearch search({1, 0, false}, 1);
    const Sequence found = search.Open(problem);
    EXPECT_NEAR(found.cost, expected, 1e-12);
    EXPECT_EQ(found.tails.size(), LiftsOf(found).size());
    for (const Sequence& tail : found.tails) {
      const size_t lift = LiftsOf(found)[0];
      EXPECT_EQ(tail.nodes[lift - 1], found.nodes[lift - 1]);
      EXPECT_NE(tail.nodes[lift], kNoNode);
    }
    elsewhere += expected > place + 1e-9;
  }
  EXPECT_GT(looked, 50);
  EXPECT_GT(elsewhere, 20);
}

TEST(LiftedSearch, FindsTheSameWhenItKeepsWhatItKnows) {
  RandomStream stream(35, 0);
  for (int round = 0; round < 60; ++round) {
    std::vector<Layer> layers = SmallLayers(stream, 5);
    std::vector<uint64_t> versions(layers.size(), 0);
    LadderProblem problem{layers, SmallRule(), {}, false, false, {}, {}};
    problem.versions = versions;
    const LiftPrice price{2, 0.02, round % 2 == 1};
    LiftedSearch kept(price);
    for (int strike = 0; strike < 6; ++strike) {
      LiftedSearch anew(price);
      const std::optional<Sequence> found = kept.Round(problem), expected = anew.Round(problem);
      ASSERT_EQ(found.has_value(), expected.has_value());
      const Sequence open = kept.Open(problem);
      EXPECT_EQ(open.nodes, anew.Open(problem).nodes);
      if (!found) break;
      EXPECT_EQ(found->nodes, expected->nodes);
      EXPECT_EQ(found->break_before, expected->break_before);
      const auto t = static_cast<size_t>(stream.Below(5));
      ++versions[t];
      const double was = layers[t].objective[found->nodes[t]];
      layers[t].objective[found->nodes[t]] = kInfinity;
      if (!layers[t].usable()) layers[t].objective[found->nodes[t]] = was;
    }
  }
}

}  // namespace
}  // namespace millpose
