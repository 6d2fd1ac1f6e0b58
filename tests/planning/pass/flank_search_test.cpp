// SPDX-License-Identifier: GPL-3.0-or-later
// The search with the gears' flanks as state, held against every sequence there is.
#include "planning/pass/flank_search.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "base/random.hpp"

namespace millpose {
namespace {

constexpr int kPlaces = 3, kBranches = 2;

/// Layers of random nodes: every joint moves by far more than its gap between any two.
struct RandomFlanks {
  LostMotion lost;
  std::vector<std::vector<FlankNode>> layers;
  std::vector<Joints> max_step;

  RandomFlanks(uint64_t seed, size_t count, bool loaded) {
    RandomStream random(seed, 0);
    for (int i = 0; i < 6; ++i) lost.width[i] = DegToRad(0.002 + 0.003 * random.Uniform());
    if (loaded) lost.friction.setConstant(0.5);
    for (size_t t = 0; t < count; ++t) {
      layers.emplace_back();
      max_step.push_back(Joints::Constant(t == 1 ? 0.09 : 1));  // bars some of the steps
      for (int branch = 0; branch < kBranches; ++branch)
        for (int place = 0; place < kPlaces; ++place) layers.back().push_back(Node(random, branch, place));
    }
  }

  FlankNode Node(RandomStream& random, int branch, int place) const {
    FlankNode node;
    node.branch = branch;
    node.place = place;
    node.freedoms = {0.1 * place};
    for (int i = 0; i < 6; ++i) node.q[i] = 0.1 * random.Uniform();
    node.face.gears.place.at = AtGears(lost, node.q);
    for (int i = 0; i < 6; ++i) {
      node.face.gears.levers[i] = 2000 * (random.Uniform() - 0.5);
      node.face.gears.place.load[i] = 1.2 * (random.Uniform() - 0.5);
    }
    node.face.low = 0.02 * (random.Uniform() - 0.5);
    node.face.high = node.face.low + 0.01 * random.Uniform();
    node.face.counts = random.Uniform() < 0.8;
    return node;
  }

  FlankRules Rules(bool closed) const {
    FlankRules rules{.lost = lost, .max_step = max_step, .stop = {}};
    rules.window = kPlaces;
    rules.motion_weight = 0.3;
    rules.displaced_weight = 0.7;
    rules.crossing_cost = 0.003;
    rules.closed = closed;
    return rules;
  }
};

/// Worst and sum of a sequence, by the model of the gears alone; infinite where a step is too large.
std::pair<double, double> ValueOf(const RandomFlanks& given, const FlankRules& rules,
                                  const std::vector<size_t>& nodes) {
  std::vector<FacePlace> places;
  double motion = 0;
  const size_t count = nodes.size();
  for (size_t t = 0; t < count; ++t) {
    const FlankNode& node = given.layers[t][nodes[t]];
    places.push_back(node.face);
    if (t + 1 == count && !rules.closed) break;
    const FlankNode& next = given.layers[(t + 1) % count][nodes[(t + 1) % count]];
    const Joints step = next.q - node.q;
    if (next.branch != node.branch || (step.cwiseAbs().array() > given.max_step[t].array()).any())
      return {kInfinity, kInfinity};
    motion += rules.motion_weight * step.squaredNorm();
  }
  const FaceChoiceFigures figures = FiguresOf(given.lost, std::move(places), rules.closed);
  const int crossings = std::accumulate(figures.crossings.begin(), figures.crossings.end(), 0);
  return {figures.worst,
          rules.displaced_weight * figures.sum + figures.marks + rules.crossing_cost * crossings + motion};
}

/// The least sum of the sequences whose worst is least, of all there are.
std::pair<double, double> BestOfAll(const RandomFlanks& given, const FlankRules& rules) {
  std::pair best{kInfinity, kInfinity};
  std::vector<size_t> nodes(given.layers.size(), 0);
  for (bool more = true; more;) {
    auto value = ValueOf(given, rules, nodes);
    if (std::abs(value.first - best.first) < 1e-12) value.first = best.first;
    best = std::min(best, value);
    more = false;
    for (size_t t = 0; t < nodes.size() && !more; ++t) {
      more = ++nodes[t] < given.layers[t].size();
      if (!more) nodes[t] = 0;
    }
  }
  return best;
}

void ExpectBestOfAll(bool closed, bool loaded) {
  int served = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const RandomFlanks given(seed, 5, loaded);
    const FlankRules rules = given.Rules(closed);
    const auto [worst, sum] = BestOfAll(given, rules);
    const std::vector<size_t> found = SearchFlanks(given.layers, rules);
    ASSERT_EQ(found.empty(), !std::isfinite(worst)) << seed;
    if (found.empty()) continue;
    ++served;
    const auto [found_worst, found_sum] = ValueOf(given, rules, found);
    EXPECT_NEAR(found_worst, worst, 1e-12) << seed;
    EXPECT_NEAR(found_sum, sum, 1e-12) << seed;
  }
  EXPECT_GT(served, 6);
}

TEST(SearchFlanks, IsTheBestOfAllSequences) { ExpectBestOfAll(false, false); }

TEST(SearchFlanks, IsTheBestOfAllSequencesUnderLoad) { ExpectBestOfAll(false, true); }

TEST(SearchFlanks, IsTheBestOfAllRings) { ExpectBestOfAll(true, false); }

TEST(SearchFlanks, GivesUpOfTheWorstWhatSlackAllows) {
  int cheaper = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const RandomFlanks given(seed, 6, false);
    FlankRules rules = given.Rules(false);
    const std::vector<size_t> strict = SearchFlanks(given.layers, rules);
    rules.slack = 0.2;
    const std::vector<size_t> slack = SearchFlanks(given.layers, rules);
    ASSERT_EQ(strict.empty(), slack.empty());
    if (strict.empty()) continue;
    const auto [worst, sum] = ValueOf(given, rules, strict);
    const auto [slack_worst, slack_sum] = ValueOf(given, rules, slack);
    EXPECT_LE(slack_worst, 1.2 * worst * (1 + 1e-9));
    EXPECT_LE(slack_sum, sum + 1e-12);
    cheaper += slack_sum < sum - 1e-9;
    rules.slack = 0;
    rules.limit = 1.2 * worst;
    EXPECT_EQ(SearchFlanks(given.layers, rules), slack);
  }
  EXPECT_GT(cheaper, 3);
}

/// A joint that goes to and fro leaves a step of h·R where it turns, and none where the place does not count.
TEST(FaceFigures, AJointThatTurnsBackLeavesAStep) {
  LostMotion lost;
  lost.width[2] = DegToRad(0.3 / 60);
  std::vector<FacePlace> places(3);
  for (FacePlace& place : places) {
    place.counts = true;
    place.gears.levers.setZero();
    place.gears.levers[2] = 1000;
  }
  places[1].gears.place.at[2] = DegToRad(1.0);
  const FaceChoiceFigures figures = FiguresOf(lost, places, false);
  EXPECT_DOUBLE_EQ(figures.marks, lost.width[2] * 1000);
  EXPECT_DOUBLE_EQ(figures.worst, lost.width[2] * 500);
  EXPECT_EQ(figures.crossings[2], 1);
  places[1].counts = false;
  EXPECT_EQ(FiguresOf(lost, places, false).marks, 0);
}

}  // namespace
}  // namespace millpose
