// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/lifted_search.hpp"

#include "base/units.hpp"
#include "planning/ladder/first_node.hpp"
#include "planning/ladder/sweep.hpp"
#include "planning/ladder/worst_then_sum.hpp"

namespace millpose {
namespace {

/// A sweep for each number of lifts: row j may be entered anew from where row j − 1 has come to.
class LiftedSweep {
 public:
  LiftedSweep(const LadderProblem& problem, size_t most, size_t over, double break_penalty)
      : problem_(problem), over_(over) {
    for (size_t j = 0; j <= most; ++j) sweeps_.emplace_back(problem, break_penalty);
  }

  /// Sweeps from the nodes first..last−1 of layer 0. False where the last row does not come to the end.
  template <size_t kRows>
  bool Forward(std::array<SweepMemory, kRows>& memories, size_t first, size_t last, bool breaks,
               std::span<const char> may) {
    bool reached = false;
    for (size_t j = 0; j < sweeps_.size(); ++j) {
      std::vector<double> enter;
      for (size_t t = 0; j > 0 && t < problem_.layers.size(); ++t)
        enter.push_back((may.empty() || may[t]) && JoinedFrom(t) ? Enter(j - 1, t) : kInfinity);
      reached = sweeps_[j].Forward(memories[j].RowsFor(first, last), first, last, breaks, std::move(enter));
    }
    return reached;
  }

  const Sweep& row(size_t j) const { return sweeps_[j]; }

  /// The sequence that ends in `node` of the last layer after at most `j` lifts.
  Sequence Trace(size_t j, size_t node) const {
    Sequence sequence;
    sequence.nodes.assign(problem_.layers.size(), kNoNode);
    sequence.break_before.assign(problem_.layers.size(), false);
    size_t entered = sweeps_[j].TraceFrom(node, sequence);
    while (entered != kNoNode) {
      Sequence before;
      before.nodes.assign(problem_.layers.size(), kNoNode);
      before.break_before.assign(problem_.layers.size(), false);
      const size_t lift = entered;
      const Sweep& row = sweeps_[--j];
      entered = over_ > 0 && lift + over_ == problem_.layers.size() ? row.TraceFrom(row.least_node(), before)
                                                                    : row.TraceBefore(lift + over_, before);
      Join(before, lift, sequence);
    }
    return sequence;
  }

 private:
  /// Cost with which layer t may be entered from row j: where that has come to `over_` layers on.
  double Enter(size_t j, size_t t) const {
    const double spare = problem_.worst ? 0 : Spare(t);
    if (over_ > 0 && t + over_ == problem_.layers.size()) return sweeps_[j].least() - spare;
    return t + over_ < problem_.layers.size() ? sweeps_[j].LeastBefore(t + over_) - spare : kInfinity;
  }

  /// What an end that runs on from layer t costs at the least: it is cut already, and does not count.
  double Spare(size_t t) const {
    double sum = 0;
    for (size_t k = t; k < t + over_ && k < problem_.layers.size(); ++k)
      sum += *std::ranges::min_element(problem_.layers[k].objective);
    return sum;
  }

  /// Whether nothing lifts the tool on the layers that the end of a part runs over from `t` on.
  bool JoinedFrom(size_t t) const {
    for (size_t k = t; k <= t + over_ && k < problem_.layers.size(); ++k) {
      if (!problem_.layers[k].usable()) return false;
      if (k > t && !problem_.break_before.empty() && problem_.break_before[k]) return false;
    }
    return true;
  }

  /// Puts the part `before` in front of `sequence`, which begins at `lift`.
  void Join(const Sequence& before, size_t lift, Sequence& sequence) const {
    for (size_t t = 0; t < lift; ++t) {
      sequence.nodes[t] = before.nodes[t];
      sequence.break_before[t] = before.break_before[t];
    }
    sequence.cost += before.cost - Spare(lift);
    if (over_ == 0) return;
    Sequence& tail = sequence.tails.emplace_back();
    tail.nodes.assign(before.nodes.size(), kNoNode);
    tail.break_before.assign(before.nodes.size(), false);
    for (size_t t = lift - 1; t < lift + over_; ++t) tail.nodes[t] = before.nodes[t];
  }

  const LadderProblem& problem_;
  size_t over_;
  std::vector<Sweep> sweeps_;
};

size_t CountBreaks(const Sequence& sequence) {
  return static_cast<size_t>(std::ranges::count(sequence.break_before, true));
}

SequenceValue ValueOf(const LadderProblem& problem, const Sequence& sequence) {
  return {WorstOf(problem.layers, sequence), sequence.cost};
}

}  // namespace

std::vector<size_t> LiftsOf(const Sequence& sequence) {
  std::vector<size_t> lifts;
  for (size_t t = 0; t < sequence.break_before.size(); ++t)
    if (sequence.break_before[t]) lifts.push_back(t);
  return lifts;
}

size_t WorthLifting(std::span<const SequenceValue> values, const LiftPrice& price) {
  const auto cheapest = [&](size_t from, double SequenceValue::*of, double most_worst) {
    size_t best = from;
    double least = values[from].*of;
    for (size_t j = from + 1; j < values.size(); ++j) {
      const double priced = values[j].*of + static_cast<double>(j - from) * price.gain * values[from].*of;
      if (priced < least && values[j].worst <= most_worst) least = priced, best = j;
    }
    return best;
  };
  if (!price.worst_first) return cheapest(0, &SequenceValue::cost, kInfinity);
  const size_t worst = cheapest(0, &SequenceValue::worst, kInfinity);
  return cheapest(worst, &SequenceValue::cost, values[worst].worst * (1 + 2 * kWorstTolerance));
}

std::vector<Sequence> LiftedSearch::OpenRows(const LadderProblem& problem, size_t most,
                                             std::span<const char> may, Memories& memories) {
  LiftedSweep sweep(problem, most, over_, BreakPenalty(problem));
  Sequence none;
  none.nodes.assign(problem.layers.size(), kNoNode);
  none.break_before.assign(problem.layers.size(), false);
  none.cost = kInfinity;
  std::vector<Sequence> rows(most + 1, none);
  if (!sweep.Forward(memories, 0, problem.layers[0].size(), true, may)) return rows;
  for (size_t j = 0; j <= most; ++j) rows[j] = sweep.Trace(j, sweep.row(j).least_node());
  return rows;
}

Sequence LiftedSearch::Open(const LadderProblem& problem, std::span<const char> may) {
  const auto choose = [&](const LadderProblem& of, Memories& memories, const LiftPrice& price) {
    std::vector<Sequence> rows = OpenRows(of, price_.most, may, memories);
    std::vector<SequenceValue> values;
    for (const Sequence& row : rows) values.push_back(ValueOf(problem, row));
    return std::move(rows[WorthLifting(values, price)]);
  };
  LiftPrice sum = price_;
  sum.worst_first = false;
  if (!price_.worst_first) return choose(problem, open_, sum);
  // The fewest lifts for the worst value first; then more of them where the sum is worth it.
  LadderProblem for_worst = problem;
  for_worst.worst = true;
  for_worst.rule.motion_weight = 0;
  std::vector<Sequence> rows = OpenRows(for_worst, price_.most, may, for_worst_);
  std::vector<SequenceValue> values;
  for (const Sequence& row : rows) values.push_back({WorstOf(problem.layers, row), 0});
  const size_t worst = WorthLifting(values, price_);
  rows = OpenRows(Within(problem, values[worst].worst), price_.most, may, open_);
  std::vector<SequenceValue> costs;
  for (size_t j = worst; j < rows.size(); ++j) costs.push_back(ValueOf(problem, rows[j]));
  return std::move(rows[worst + WorthLifting(costs, sum)]);
}

/// The cheapest sequence round with at most `lifts` lifts.
std::optional<Sequence> LiftedSearch::RoundWith(const LadderProblem& problem, size_t lifts, int max_sweeps) {
  Sequence seam = OpenRows(problem, lifts - 1, {}, open_).back();
  std::optional<Sequence> best;
  const bool whole = std::ranges::all_of(seam.nodes, [](size_t node) { return node != kNoNode; });
  if (whole && CountBreaks(seam) <= lifts - 1 && WorstOf(problem.layers, seam) <= problem.most) {
    seam.break_before[0] = true;
    best = std::move(seam);
  }
  LiftedSweep sweep(problem, lifts, over_, kInfinity);
  const auto round = [&](size_t first, size_t last) -> std::optional<millpose::Round> {
    if (!sweep.Forward(round_, first, last, false, {})) return std::nullopt;
    const Sweep::Closing closing = sweep.row(lifts).Close(first, last);
    if (!std::isfinite(closing.by.cost)) return std::nullopt;
    return millpose::Round{closing.by.cost, closing.into, sweep.Trace(lifts, closing.by.node)};
  };
  std::optional<Sequence> within = BranchOverFirst(problem.layers[0].base, round, max_sweeps);
  // Beyond the seam nothing is known of the end that runs on.
  if (within && (!best || over_ > 0 || within->cost < best->cost)) best = std::move(within);
  return best;
}

std::optional<Sequence> LiftedSearch::BestRoundWith(const LadderProblem& problem, size_t lifts,
                                                    int max_sweeps) {
  if (!price_.worst_first) return RoundWith(problem, lifts, max_sweeps);
  const auto search = [&](const LadderProblem& of, int sweeps) {
    return RoundWith(of, lifts, std::min(sweeps, max_sweeps));
  };
  const std::optional<Sequence> least = LeastWorst(problem, search);
  if (!least) return std::nullopt;
  std::optional<Sequence> best =
      RoundWith(Within(problem, WorstOf(problem.layers, *least)), lifts, max_sweeps);
  return best ? best : least;
}

std::optional<Sequence> LiftedSearch::Round(const LadderProblem& problem, int max_sweeps) {
  for (const Layer& layer : problem.layers)
    if (!layer.usable()) return std::nullopt;
  std::vector<Sequence> found;
  std::vector<SequenceValue> values;
  for (size_t lifts = 1; lifts <= kMostLifts + 1; ++lifts) {
    if (lifts > price_.most + 1 && !found.empty()) break;
    std::optional<Sequence> best = BestRoundWith(problem, lifts, max_sweeps);
    if (!best) continue;
    values.push_back(ValueOf(problem, *best));
    found.push_back(std::move(*best));
  }
  if (found.empty()) return std::nullopt;
  return std::move(found[WorthLifting(values, price_)]);
}

}  // namespace millpose
