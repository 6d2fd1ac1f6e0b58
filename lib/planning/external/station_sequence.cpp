// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/external/station_sequence.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "base/units.hpp"

namespace millpose {
namespace {

using Choices = std::vector<CourseScore>;  // of one pass

size_t FewestLost(const Choices& choices) {
  size_t fewest = std::numeric_limits<size_t>::max();
  for (const CourseScore& choice : choices) fewest = std::min(fewest, choice.score.lost);
  return fewest;
}

/// The least that the worst sampled point of all can be.
double LeastWorst(const std::vector<Choices>& passes, const std::vector<size_t>& lost) {
  double bound = 0;
  for (size_t p = 0; p < lost.size(); ++p) {
    double least = kInfinity;
    for (const CourseScore& choice : passes[p])
      if (choice.score.lost == lost[p]) least = std::min(least, choice.score.worst);
    bound = std::max(bound, least);
  }
  return bound;
}

/// Of each choice: the pass's objective in shares of its own best; infinite where it may not be taken.
std::vector<double> CostsOf(const Choices& choices, size_t lost, double bound) {
  std::vector<double> costs(choices.size(), kInfinity);
  double best = kInfinity;
  for (size_t c = 0; c < choices.size(); ++c) {
    const StationScore& score = choices[c].score;
    if (score.lost != lost || score.worst > bound) continue;
    costs[c] = score.sum;
    best = std::min(best, score.sum);
  }
  for (double& cost : costs)
    if (cost < kInfinity) cost = best > 0 ? cost / best : 1;
  return costs;
}

/// The cheapest sequence, with a price for every change; the first of equals.
std::vector<size_t> Cheapest(const std::vector<Choices>& passes,
                             const std::vector<std::vector<double>>& costs) {
  const auto least_of = [](const std::vector<double>& values) {
    return static_cast<size_t>(std::ranges::min_element(values) - values.begin());
  };
  std::vector<std::vector<size_t>> from(passes.size());
  std::vector<double> before = costs.front();
  for (size_t p = 1; p < passes.size(); ++p) {
    const size_t least = least_of(before);
    std::map<size_t, size_t> ending;  // by station: the cheapest choice that ends there
    for (size_t c = 0; c < before.size(); ++c) {
      const auto [known, added] = ending.try_emplace(passes[p - 1][c].to, c);
      if (!added && before[c] < before[known->second]) known->second = c;
    }
    std::vector<double> now(passes[p].size());
    from[p].resize(passes[p].size());
    for (size_t c = 0; c < passes[p].size(); ++c) {
      const auto here = ending.find(passes[p][c].from);
      const bool stays = here != ending.end() && before[here->second] <= before[least] + kChangePrice;
      from[p][c] = stays ? here->second : least;
      now[c] = costs[p][c] + (stays ? before[here->second] : before[least] + kChangePrice);
    }
    before = std::move(now);
  }
  std::vector<size_t> sequence(passes.size());
  sequence.back() = least_of(before);
  for (size_t p = passes.size() - 1; p > 0; --p) sequence[p - 1] = from[p][sequence[p]];
  return sequence;
}

/// Choices of a pass, the best first but for the one that leads.
std::vector<size_t> Ranked(const Choices& choices, size_t first, size_t next) {
  std::vector<size_t> all(choices.size());
  std::iota(all.begin(), all.end(), size_t{0});
  std::erase(all, first);
  std::ranges::stable_sort(all, [&](size_t a, size_t b) { return choices[a].score < choices[b].score; });
  all.resize(std::min(all.size(), next));
  all.insert(all.begin(), first);
  return all;
}

}  // namespace

bool StationScore::operator<(const StationScore& other) const {
  return std::tie(lost, worst, sum) < std::tie(other.lost, other.worst, other.sum);
}

bool StationSequence::IsBetter(const StationSequence& other) const {
  return std::tie(lost, worst, sum) < std::tie(other.lost, other.worst, other.sum);
}

StationSequence FindCourseSequence(const std::vector<std::vector<CourseScore>>& choices, bool worst_first,
                                   size_t next) {
  StationSequence found;
  const size_t passes = choices.size();
  if (passes == 0) return found;
  std::vector<size_t> lost;
  for (const Choices& of : choices) lost.push_back(FewestLost(of));
  const double bound = worst_first ? LeastWorst(choices, lost) : kInfinity;
  std::vector<std::vector<double>> costs;
  for (size_t p = 0; p < passes; ++p) costs.push_back(CostsOf(choices[p], lost[p], bound));
  const std::vector<size_t> sequence = Cheapest(choices, costs);
  for (size_t p = 0; p < passes; ++p) {
    found.ranked.push_back(Ranked(choices[p], sequence[p], next));
    const CourseScore& choice = choices[p][sequence[p]];
    found.lost += choice.score.lost;
    found.sum += choice.score.sum;
    if (worst_first) found.worst = std::max(found.worst, choice.score.worst);
    found.changes += p > 0 && choice.from != choices[p - 1][sequence[p - 1]].to;
  }
  return found;
}

}  // namespace millpose
