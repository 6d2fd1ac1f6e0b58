// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/worst_then_sum.hpp"

#include "base/units.hpp"
#include "planning/ladder/returning.hpp"

namespace millpose {
namespace {

constexpr int kSweeps = 16;            // of a closed search that only asks whether there is a sequence
constexpr double kNearEnough = 1.001;  // between the bounds of a bisection
constexpr size_t kFewValues = 64;      // are bisected to the end

/// No sequence without breaks but those that are asked for has a smaller worst value: the largest of the
/// layers' least ones; +inf where some layer has no node.
double LeastWorstOf(const LadderProblem& problem) {
  double least = 0;
  for (const Layer& layer : problem.layers)
    least = std::max(least, layer.size() == 0 ? kInfinity : *std::ranges::min_element(layer.objective));
  return least <= problem.most ? least : kInfinity;
}

size_t BreaksAskedFor(const LadderProblem& problem) {
  if (problem.break_before.empty()) return 0;
  return problem.break_before.size() - static_cast<size_t>(std::ranges::count(problem.break_before, 0)) -
         (problem.break_before[0] != 0 ? 1 : 0);
}

}  // namespace

LadderProblem Within(LadderProblem problem, double bound) {
  problem.most = std::min(problem.most, bound * (1 + kWorstTolerance));
  return problem;
}

double WorstOf(std::span<const Layer> layers, const Sequence& sequence) {
  double worst = 0;
  for (size_t t = 0; t < sequence.nodes.size(); ++t)
    if (sequence.nodes[t] != kNoNode) worst = std::max(worst, layers[t].objective[sequence.nodes[t]]);
  return worst;
}

Sequence WorstThenSum::Open(const LadderProblem& problem) {
  if (std::isfinite(bound_)) {
    Sequence sequence = SearchOpen(Within(problem, bound_));
    if (Breaks(sequence) <= breaks_) return sequence;
  }
  // One search suffices where the worst value is that of a point which has none better.
  const double least_bound = LeastWorstOf(problem);
  if (std::isfinite(least_bound) && !(least_bound <= bound_ && std::isfinite(bound_))) {
    Sequence sequence = SearchOpen(Within(problem, least_bound));
    if (Breaks(sequence) <= BreaksAskedFor(problem) && WorstOf(problem.layers, sequence) == least_bound) {
      bound_ = least_bound;
      breaks_ = Breaks(sequence);
      return sequence;
    }
  }
  LadderProblem for_worst = problem;
  for_worst.worst = true;
  for_worst.rule.motion_weight = 0;
  if (problem.memory) for_worst.memory = &memory_;
  const Sequence least = SearchOpen(for_worst);
  bound_ = WorstOf(problem.layers, least);
  breaks_ = Breaks(least);
  return SearchOpen(Within(problem, bound_));
}

std::optional<Sequence> WorstThenSum::Closed(const LadderProblem& problem) {
  bound_ = LeastClosedBound(problem);
  if (!std::isfinite(bound_)) return std::nullopt;
  return SearchClosed(Within(problem, bound_));
}

std::optional<Sequence> LeastWorst(const LadderProblem& problem, const BoundedSearch& search) {
  std::optional<Sequence> best = search(problem, kSweeps);
  if (!best) best = search(problem, std::numeric_limits<int>::max());
  if (!best) return std::nullopt;
  const std::vector<double> values = PossibleBounds(problem, WorstOf(problem.layers, *best));
  // Below `low` there is none; at `high` there is `best`.
  size_t low = 0, high = values.size() - 1;
  while (low < high && (high - low <= kFewValues || values[high] > kNearEnough * values[low])) {
    const size_t middle = low + (high - low) / 2;
    if (auto found = search(Within(problem, values[middle]), kSweeps)) {
      const double worst = WorstOf(problem.layers, *found);
      high = static_cast<size_t>(std::lower_bound(values.begin(), values.end(), worst) - values.begin());
      high = std::min(high, middle);
      best = std::move(found);
    } else {
      low = middle + 1;
    }
  }
  return best;
}

}  // namespace millpose
