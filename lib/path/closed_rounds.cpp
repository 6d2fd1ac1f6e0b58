// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/closed_rounds.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMore = 0.03;  // that a sequence may cost above the one before; then ever more
constexpr double kAnew = 1.1;   // times what one cost when its node was chosen: another may now be better
constexpr int kRaises = 5;      // of the limit, each by twice as much; then there is none

}  // namespace

std::optional<Sequence> ClosedRounds::Search(const LadderProblem& problem, int max_sweeps) {
  for (const Layer& layer : problem.layers)
    if (!layer.usable()) return std::nullopt;
  if (last_ > first_) {
    double from = limit_ / (1 + kMore), more = kMore;
    for (int raise = 0; raise <= kRaises; ++raise, more *= 2) {
      if (raise == 1) from = std::max(from, LeastThrough(problem));
      if (raise > 0) limit_ = raise < kRaises ? (1 + more) * from : kInfinity;
      std::optional<Sequence> found = Through(problem);
      if (!found) continue;
      if (!std::isfinite(limit_)) limit_ = (1 + kMore) * found->cost;
      if (found->cost <= kAnew * chosen_at_) return found;
      chosen_at_ = found->cost;
      std::optional<Sequence> other = SearchClosed(problem, max_sweeps);
      if (!other || !(other->cost < found->cost)) return found;
      GoOnFrom(problem, *other);
      return other;
    }
  }
  std::optional<Sequence> found = SearchClosed(problem, max_sweeps);
  if (found) GoOnFrom(problem, *found);
  return found;
}

void ClosedRounds::GoOnFrom(const LadderProblem& problem, const Sequence& sequence) {
  const std::vector<size_t>& base = problem.layers[0].base;
  const size_t node = sequence.nodes[0];
  first_ = last_ = node;
  while (first_ > 0 && base[first_ - 1] == base[node]) --first_;
  while (last_ < base.size() && base[last_] == base[node]) ++last_;
  limit_ = (1 + kMore) * sequence.cost;
  chosen_at_ = sequence.cost;
  rows_ = {};
  LeastThrough(problem);
}

/// No sequence through the node costs less. What the rest of one costs from any node on is brought up to
/// date.
double ClosedRounds::LeastThrough(const LadderProblem& problem) {
  const ToGo& to_go = LeastToGo(
      problem, [](size_t, size_t) { return true; }, backward_);
  double least = kInfinity;
  for (size_t node = first_; node < last_; ++node)
    least = std::min(least, problem.layers[0].objective[node] + to_go[0][node]);
  return least;
}

/// The best through the node, if it costs no more than the limit.
std::optional<Sequence> ClosedRounds::Through(const LadderProblem& problem) {
  Sweep sweep(problem, kInfinity);
  sweep.LeaveOutAbove(limit_, backward_.to_go);
  if (!sweep.Forward(rows_, first_, last_, false)) return std::nullopt;
  const Sweep::Closing closing = sweep.Close(first_, last_);
  // Above the limit it need not be the best: parts of better ones may have been left out.
  if (!std::isfinite(closing.by.cost) || closing.by.cost > limit_) return std::nullopt;
  Sequence sequence = sweep.Trace(closing.by.node);
  sequence.cost = closing.by.cost;
  sequence.closed = true;
  return sequence;
}

}  // namespace millpose
