// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/station_sequence.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Scores = std::vector<std::vector<StationScore>>;

size_t FewestLost(const Scores& scores, size_t pass) {
  size_t fewest = std::numeric_limits<size_t>::max();
  for (const auto& station : scores) fewest = std::min(fewest, station[pass].lost);
  return fewest;
}

/// The least that the worst sampled point of all can be.
double LeastWorst(const Scores& scores, const std::vector<size_t>& lost) {
  double bound = 0;
  for (size_t p = 0; p < lost.size(); ++p) {
    double least = kInfinity;
    for (const auto& station : scores)
      if (station[p].lost == lost[p]) least = std::min(least, station[p].worst);
    bound = std::max(bound, least);
  }
  return bound;
}

/// Of each station: the pass's objective in shares of its own best; infinite where it may not be milled.
std::vector<double> CostsOf(const Scores& scores, size_t pass, size_t lost, double bound) {
  std::vector<double> costs(scores.size(), kInfinity);
  double best = kInfinity;
  for (size_t s = 0; s < scores.size(); ++s) {
    const StationScore& score = scores[s][pass];
    if (score.lost != lost || score.worst > bound) continue;
    costs[s] = score.sum;
    best = std::min(best, score.sum);
  }
  for (double& cost : costs)
    if (cost < kInfinity) cost = best > 0 ? cost / best : 1;
  return costs;
}

/// The cheapest sequence, with a price for every change; the first of equals.
std::vector<size_t> Cheapest(const std::vector<std::vector<double>>& costs) {
  const size_t stations = costs.front().size();
  std::vector<std::vector<size_t>> from(costs.size(), std::vector<size_t>(stations));
  std::vector<double> before = costs.front();
  for (size_t p = 1; p < costs.size(); ++p) {
    const auto least = static_cast<size_t>(std::ranges::min_element(before) - before.begin());
    std::vector<double> now(stations);
    for (size_t s = 0; s < stations; ++s) {
      const bool stays = before[s] <= before[least] + kChangePrice;
      from[p][s] = stays ? s : least;
      now[s] = costs[p][s] + (stays ? before[s] : before[least] + kChangePrice);
    }
    before = std::move(now);
  }
  std::vector<size_t> sequence(costs.size());
  sequence.back() = static_cast<size_t>(std::ranges::min_element(before) - before.begin());
  for (size_t p = costs.size() - 1; p > 0; --p) sequence[p - 1] = from[p][sequence[p]];
  return sequence;
}

/// Stations of a pass, the best first but for the one that leads.
std::vector<size_t> Ranked(const Scores& scores, size_t pass, size_t first, size_t next) {
  std::vector<size_t> all(scores.size());
  std::iota(all.begin(), all.end(), size_t{0});
  std::erase(all, first);
  std::ranges::stable_sort(all, [&](size_t a, size_t b) { return scores[a][pass] < scores[b][pass]; });
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

StationSequence FindStationSequence(const std::vector<std::vector<StationScore>>& scores, bool worst_first,
                                    size_t next) {
  StationSequence found;
  const size_t passes = scores.front().size();
  if (passes == 0) return found;
  std::vector<size_t> lost;
  for (size_t p = 0; p < passes; ++p) lost.push_back(FewestLost(scores, p));
  const double bound = worst_first ? LeastWorst(scores, lost) : kInfinity;
  std::vector<std::vector<double>> costs;
  for (size_t p = 0; p < passes; ++p) costs.push_back(CostsOf(scores, p, lost[p], bound));
  const std::vector<size_t> sequence = Cheapest(costs);
  for (size_t p = 0; p < passes; ++p) {
    found.ranked.push_back(Ranked(scores, p, sequence[p], next));
    const StationScore& score = scores[sequence[p]][p];
    found.lost += score.lost;
    found.sum += score.sum;
    if (worst_first) found.worst = std::max(found.worst, score.worst);
    found.changes += p > 0 && sequence[p] != sequence[p - 1];
  }
  return found;
}

}  // namespace millpose
