// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/layered_search.hpp"

#include <queue>

#include "path/sweep.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// More than any sequence can cost, so that one break less always wins.
double BreakPenalty(const LayeredProblem& problem) {
  double sum = 0.0, largest = 0.0;
  for (const Layer& layer : problem.layers) {
    double least = kInfinity, most = -kInfinity;
    for (const double value : layer.objective) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    if (most > least) sum += most - least;
    largest = std::max(largest, most);
    sum += problem.rule.motion_weight * problem.rule.max_step.squaredNorm();
  }
  // A power of two, so that a largest value can carry its breaks beside it (Sweep).
  if (problem.worst) return std::ldexp(1.0, std::ilogb(std::max(largest, 1e-9)) + 2);
  return 2.0 * sum + 1e-9;
}

/// A set of first nodes, first..last−1, and what is known about closed sequences through it.
struct Part {
  size_t first, last;
  double bound;        ///< no closed sequence through the set costs less
  size_t start, into;  ///< of the sequence that gives the bound
};
/// The nodes that differ from `node` by full turns only: first, and one beyond the last.
size_t GroupBegin(const std::vector<size_t>& base, size_t node) {
  while (node > 0 && base[node - 1] == base[node]) --node;
  return node;
}
size_t GroupEnd(const std::vector<size_t>& base, size_t node) {
  const size_t group = base[node];
  while (node < base.size() && base[node] == group) ++node;
  return node;
}

struct Costlier {
  bool operator()(const Part& a, const Part& b) const {
    return a.bound != b.bound ? a.bound > b.bound : a.first > b.first;
  }
};

}  // namespace

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

Sequence SearchOpen(const LayeredProblem& problem) {
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

std::optional<Sequence> SearchClosed(const LayeredProblem& problem, int max_sweeps) {
  for (const Layer& layer : problem.layers) {
    if (!layer.usable()) return std::nullopt;
  }
  SweepMemory own;
  SweepMemory& memory = problem.memory ? *problem.memory : own;
  Sweep sweep(problem, kInfinity);
  const std::vector<size_t>& base = problem.layers[0].base;
  std::optional<Sequence> best;
  std::priority_queue<Part, std::vector<Part>, Costlier> open;
  const auto bound = [&](size_t first, size_t last) {
    if (first >= last || --max_sweeps < 0) return;
    if (!sweep.Forward(memory.RowsFor(first, last), first, last, false)) return;
    const Sweep::Closing closing = sweep.Close(first, last);
    if (!std::isfinite(closing.by.cost)) return;
    Sequence sequence = sweep.Trace(closing.by.node);
    const size_t start = sequence.nodes[0];
    if (base[start] != base[closing.into]) {
      open.push({first, last, closing.by.cost, start, closing.into});
    } else if (!best || closing.by.cost < best->cost) {
      sequence.cost = closing.by.cost;
      sequence.closed = true;
      best = std::move(sequence);
    }
  };
  bound(0, problem.layers[0].size());
  while (!open.empty()) {
    const Part part = open.top();
    open.pop();
    if (best && part.bound >= best->cost) break;  // nor can any other part be better
    // The sequence of the bound starts and ends at different nodes. A closed one has both in the half before
    // or in the half after a cut between them.
    if (!best) bound(GroupBegin(base, part.start), GroupEnd(base, part.start));
    const size_t low = std::min(part.start, part.into), high = std::max(part.start, part.into);
    size_t cut = GroupBegin(base, (low + high + 1) / 2);
    if (cut <= GroupBegin(base, low)) cut = GroupBegin(base, high);
    bound(part.first, cut);
    bound(cut, part.last);
  }
  return best;
}

}  // namespace millpose
