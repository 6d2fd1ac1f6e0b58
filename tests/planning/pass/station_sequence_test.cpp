// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/external/station_sequence.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace millpose {
namespace {

using Scores = std::vector<std::vector<StationScore>>;  // [station][pass]

/// The sequence where no station moves along passes.
StationSequence SequenceOf(const Scores& scores, bool worst_first, size_t next) {
  std::vector<std::vector<CourseScore>> passes(scores.front().size());
  for (size_t p = 0; p < passes.size(); ++p)
    for (size_t s = 0; s < scores.size(); ++s) passes[p].push_back({s, s, scores[s][p]});
  return FindCourseSequence(passes, worst_first, next);
}

/// What the law says of a sequence: infinite where a pass stands where it may not.
double CostOf(const Scores& scores, const std::vector<size_t>& sequence, bool worst_first) {
  double cost = 0, bound = 0;
  const size_t passes = sequence.size();
  std::vector<size_t> fewest(passes, 1000);
  for (size_t p = 0; p < passes; ++p) {
    for (const auto& station : scores) fewest[p] = std::min(fewest[p], station[p].lost);
    double least = 1e9;
    for (const auto& station : scores)
      if (station[p].lost == fewest[p]) least = std::min(least, station[p].worst);
    bound = std::max(bound, least);
  }
  for (size_t p = 0; p < passes; ++p) {
    const StationScore& score = scores[sequence[p]][p];
    if (score.lost != fewest[p] || (worst_first && score.worst > bound)) return 1e9;
    double best = 1e9;
    for (const auto& station : scores)
      if (station[p].lost == fewest[p] && (!worst_first || station[p].worst <= bound))
        best = std::min(best, station[p].sum);
    cost += score.sum / best;
    if (p > 0 && sequence[p] != sequence[p - 1]) cost += kChangePrice;
  }
  return cost;
}

TEST(StationSequence, IsTheCheapestOfAll) {
  RandomStream random(1, 0);
  for (int round = 0; round < 200; ++round) {
    const bool worst_first = round % 2 == 0;
    constexpr size_t kStations = 3, kPasses = 5;
    Scores scores(kStations, std::vector<StationScore>(kPasses));
    for (auto& station : scores)
      for (StationScore& score : station)
        score = {random.Uniform() < 0.2 ? 2U : 0U, random.Uniform(1, 2), random.Uniform(5, 6)};
    double least = 1e9;
    for (size_t code = 0; code < 243; ++code) {
      std::vector<size_t> sequence;
      for (size_t p = 0, rest = code; p < kPasses; ++p, rest /= 3) sequence.push_back(rest % 3);
      least = std::min(least, CostOf(scores, sequence, worst_first));
    }
    const StationSequence found = SequenceOf(scores, worst_first, 1);
    std::vector<size_t> sequence;
    for (const auto& pass : found.ranked) sequence.push_back(pass.front());
    EXPECT_NEAR(CostOf(scores, sequence, worst_first), least, 1e-12);
    for (size_t p = 0; p < kPasses; ++p) {
      ASSERT_EQ(found.ranked[p].size(), 2u);
      EXPECT_NE(found.ranked[p][0], found.ranked[p][1]);
    }
  }
}

TEST(StationSequence, OfCoursesIsTheCheapestOfAll) {
  RandomStream random(2, 0);
  int moving = 0;
  for (int round = 0; round < 200; ++round) {
    constexpr size_t kPasses = 4;
    std::vector<std::vector<CourseScore>> choices(kPasses);
    for (auto& of : choices)
      for (const auto& [from, to] : {std::pair(0, 0), std::pair(1, 1), std::pair(0, 1), std::pair(1, 0)})
        of.push_back({static_cast<size_t>(from), static_cast<size_t>(to), {0, 1, random.Uniform(5, 5.6)}});
    const auto cost = [&](const std::vector<size_t>& sequence) {
      double sum = 0;
      for (size_t p = 0; p < kPasses; ++p) {
        double best = 1e9;
        for (const CourseScore& choice : choices[p]) best = std::min(best, choice.score.sum);
        sum += choices[p][sequence[p]].score.sum / best;
        if (p > 0 && choices[p][sequence[p]].from != choices[p - 1][sequence[p - 1]].to) sum += kChangePrice;
      }
      return sum;
    };
    double least = 1e9;
    for (size_t code = 0; code < 256; ++code)
      least = std::min(least, cost({code % 4, code / 4 % 4, code / 16 % 4, code / 64}));
    const StationSequence found = FindCourseSequence(choices, round % 2 == 0, 2);
    std::vector<size_t> sequence;
    for (const auto& pass : found.ranked) {
      sequence.push_back(pass.front());
      EXPECT_EQ(pass.size(), 3u);
      moving +=
          choices[sequence.size() - 1][pass.front()].from != choices[sequence.size() - 1][pass.front()].to;
    }
    EXPECT_NEAR(cost(sequence), least, 1e-12);
  }
  EXPECT_GT(moving, 100);
}

TEST(StationSequence, StaysWhereAChangeGainsLittle) {
  const auto at = [](double sum) { return StationScore{0, 1, sum}; };
  const Scores little{{at(1), at(1.04), at(1)}, {at(1.04), at(1), at(1.04)}};
  EXPECT_EQ(SequenceOf(little, false, 0).changes, 0u);
  const Scores much{{at(1), at(1.3), at(1)}, {at(1.3), at(1), at(1.3)}};
  EXPECT_EQ(SequenceOf(much, false, 0).changes, 2u);
}

}  // namespace
}  // namespace millpose
