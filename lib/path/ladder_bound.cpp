// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/ladder_bound.hpp"

#include "path/worst_then_sum.hpp"

namespace millpose {
namespace {

/// The least cost of a closed sequence, no more than `known`, that of one.
double ClosedBound(const LadderProblem& problem, double known) {
  constexpr double kRounding = 1e-9;
  const std::optional<Sequence> better =
      SearchClosed(problem, std::numeric_limits<int>::max(), known * (1 - kRounding));
  return better ? better->cost : known;
}

}  // namespace

LadderBound BoundLadder(LadderProblem problem, const Sequence& sequence, bool worst_first) {
  LadderBound bound;
  bound.cost = sequence.cost;
  bound.worst = WorstOf(problem.layers, sequence);
  problem.walls = false;
  problem.memory = nullptr;
  problem.versions = {};
  const size_t count = problem.layers.size();
  std::vector<char> lifted(count, 0);
  for (size_t t = 1; t < count; ++t)
    lifted[t] = sequence.break_before[t] || sequence.nodes[t] == kNoNode || sequence.nodes[t - 1] == kNoNode;
  problem.break_before = lifted;
  LadderProblem for_worst = problem;
  for_worst.worst = true;
  for_worst.rule.motion_weight = 0;
  if (worst_first) problem.most = bound.worst * (1 + kWorstTolerance);
  if (sequence.closed) {
    bound.cost_bound = ClosedBound(problem, bound.cost);
    if (worst_first) bound.worst_bound = ClosedBound(for_worst, bound.worst);
  } else {
    bound.cost_bound = SearchOpen(problem).cost;
    if (worst_first) bound.worst_bound = WorstOf(problem.layers, SearchOpen(for_worst));
  }
  // Sums in another order, and layers that the sequence leaves out.
  bound.cost_bound = std::min(bound.cost_bound, bound.cost);
  bound.worst_bound = std::min(bound.worst_bound, bound.worst);
  return bound;
}

}  // namespace millpose
