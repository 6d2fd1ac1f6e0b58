// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/ladder_search.hpp"

#include "base/units.hpp"
#include "planning/ladder/sweep.hpp"

namespace millpose {

size_t Breaks(const Sequence& sequence) {
  size_t breaks = 0;
  for (size_t t = 0; t < sequence.nodes.size(); ++t)
    breaks += sequence.nodes[t] == kNoNode ? sequence.nodes.size() : sequence.break_before[t];
  return breaks;
}

double BreakPenalty(const LadderProblem& problem) {
  double sum = 0.0, largest = 0.0;
  for (size_t t = 0; t < problem.layers.size(); ++t) {
    const Layer& layer = problem.layers[t];
    double least = kInfinity, most = -kInfinity;
    for (const double value : layer.objective) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    if (most > least) sum += most - least;
    largest = std::max(largest, most);
    sum += problem.rule.motion_weight * problem.RuleFrom(t).max_step.squaredNorm();
  }
  // A power of two, so that a largest value can carry its breaks beside it (Sweep).
  if (problem.worst) return std::ldexp(1.0, std::ilogb(std::max(largest, 1e-9)) + 2);
  return 2.0 * sum + 1e-9;
}

double BandWidth(const StepRule& rule, double nominal_angle) {
  return rule.max_step.sum() + nominal_angle + 1e-9;  // rounding
}

SweepMemory::SweepMemory() = default;
SweepMemory::~SweepMemory() = default;

SweepRows& SweepMemory::RowsFor(size_t first, size_t last) {
  for (auto kept = kept_.begin(); kept != kept_.end(); ++kept) {
    if (kept->first != first || kept->last != last) continue;
    kept_.splice(kept_.begin(), kept_, kept);
    return *kept_.front().rows;
  }
  // A sweep from fewer nodes changes least against the one from the most of them.
  const Kept* widest = nullptr;
  for (const Kept& kept : kept_) {
    if (!widest || kept.last - kept.first > widest->last - widest->first) widest = &kept;
  }
  auto rows = widest ? std::make_unique<SweepRows>(*widest->rows) : std::make_unique<SweepRows>();
  if (kept_.size() == kMostKept) {
    auto oldest = std::prev(kept_.end());
    if (&*oldest == widest) --oldest;
    kept_.erase(oldest);
  }
  kept_.push_front({first, last, std::move(rows)});
  return *kept_.front().rows;
}

const std::vector<std::vector<double>>& SweepMemory::ToGoFor(const LadderProblem& problem) {
  if (!backward_) backward_ = std::make_unique<BackwardRows>();
  return LeastToGo(problem, {}, *backward_);
}

Sequence SearchOpen(const LadderProblem& problem) {
  Sequence none;
  none.nodes.assign(problem.layers.size(), kNoNode);
  none.break_before.assign(problem.layers.size(), false);
  if (problem.layers.empty()) return none;
  SweepMemory own;
  SweepMemory& memory = problem.memory ? *problem.memory : own;
  Sweep sweep(problem, BreakPenalty(problem));
  const size_t all = problem.layers[0].size();
  if (!sweep.Forward(memory.RowsFor(0, all), 0, all, true)) return none;
  return sweep.Trace(sweep.least_node());
}

}  // namespace millpose
