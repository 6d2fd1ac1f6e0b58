// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/ladder_bound.hpp"

#include "planning/ladder/returning.hpp"
#include "planning/ladder/worst_then_sum.hpp"

namespace millpose {
namespace {

/// The least cost of a closed sequence, no more than `known`, that of one.
double ClosedBound(const LadderProblem& problem, double known) {
  constexpr double kRounding = 1e-9;
  const std::optional<Sequence> better =
      SearchClosed(problem, std::numeric_limits<int>::max(), known * (1 - kRounding));
  return better ? better->cost : known;
}

/// The largest of the least objectives of layers that have nodes: no sequence through all of them has less.
double LargestLeast(std::span<const Layer> layers) {
  double largest = 0;
  for (const Layer& layer : layers)
    if (layer.usable()) largest = std::max(largest, *std::ranges::min_element(layer.objective));
  return largest;
}

/// The least worst value of a sequence that is as continuous as the given one, no more than `known`, its own.
double WorstBound(LadderProblem problem, const Sequence& sequence, double known) {
  if (LargestLeast(problem.layers) >= known) return known;
  if (sequence.closed) return LeastClosedBound(problem);
  problem.worst = true;
  problem.rule.motion_weight = 0;
  problem.memory = nullptr;
  return WorstOf(problem.layers, SearchOpen(problem));
}

/// Versions that differ from the given ones where walls made a difference to the steps from a layer.
std::vector<uint64_t> VersionsWithoutWalls(const LadderProblem& problem) {
  constexpr uint64_t kWithoutWalls = uint64_t{1} << 63;
  std::vector<uint64_t> versions(problem.versions.begin(), problem.versions.end());
  for (size_t t = 0; t < versions.size(); ++t)
    if (!std::ranges::all_of(problem.layers[t].objective, [](double value) { return std::isfinite(value); }))
      versions[t] |= kWithoutWalls;
  return versions;
}

}  // namespace

LadderBound BoundOfBest(std::span<const Layer> layers, const Sequence& sequence, bool worst_first) {
  LadderBound bound;
  bound.cost = bound.cost_bound = sequence.cost;
  bound.worst = WorstOf(layers, sequence);
  if (worst_first) bound.worst_bound = bound.worst;
  return bound;
}

LadderBound BoundLadder(LadderProblem problem, const Sequence& sequence, bool worst_first) {
  LadderBound bound;
  bound.cost = sequence.cost;
  bound.worst = WorstOf(problem.layers, sequence);
  const std::vector<uint64_t> versions = VersionsWithoutWalls(problem);
  problem.walls = false;
  problem.versions = versions;
  if (sequence.closed || versions.empty()) problem.memory = nullptr;
  const size_t count = problem.layers.size();
  std::vector<char> lifted(count, 0);
  for (size_t t = 1; t < count; ++t)
    lifted[t] = sequence.break_before[t] || sequence.nodes[t] == kNoNode || sequence.nodes[t - 1] == kNoNode;
  problem.break_before = lifted;
  if (worst_first) problem.most = bound.worst * (1 + kWorstTolerance);
  bound.cost_bound = sequence.closed ? ClosedBound(problem, bound.cost) : SearchOpen(problem).cost;
  if (worst_first) bound.worst_bound = WorstBound(problem, sequence, bound.worst);
  // Sums in another order, and layers that the sequence leaves out.
  bound.cost_bound = std::min(bound.cost_bound, bound.cost);
  bound.worst_bound = std::min(bound.worst_bound, bound.worst);
  return bound;
}

}  // namespace millpose
