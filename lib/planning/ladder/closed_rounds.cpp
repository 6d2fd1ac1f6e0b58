// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/closed_rounds.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kMoreThanBefore = 0.03;  // that a sequence may cost above the one before; then ever more
constexpr double kAnew = 1.1;  // times what one cost when its node was chosen: another may now be better
constexpr double kSurely = 1 - 1e-9;  // rounding of a lower bound
constexpr int kRaises = 5;            // of the limit, each by twice as much; then there is none

}  // namespace

std::optional<Sequence> ClosedRounds::Search(const LadderProblem& problem, int max_sweeps) {
  for (const Layer& layer : problem.layers)
    if (!layer.usable()) return std::nullopt;
  std::optional<Sequence> found, other;
  bool looked = false;
  const auto look_for_others = [&] {
    if (!looked) other = SearchClosed(problem, max_sweeps);
    looked = true;
  };
  if (last_ > first_) {
    // Where much has changed since, all through the node are likely to have become dearer than the limit.
    const bool much = MuchChanged(problem);
    if (!much) found = Through(problem);
    if (!found) {
      const double least = LeastThrough(problem);
      if (least > kAnew * chosen_at_) look_for_others();
      // Then they are looked for only if no other is better than they can be.
      if (!other || !(other->cost < kSurely * least)) found = ThroughRaised(problem, least, much ? 0 : 1);
    }
    if (found && found->cost <= kAnew * chosen_at_) return found;
    if (found) chosen_at_ = found->cost;
  }
  look_for_others();
  if (found && !(other && other->cost < found->cost)) return found;
  if (other) GoOnFrom(problem, *other);
  return other;
}

/// Through the node with the limit as it is (0) or raised ever more; no sequence through it costs less than
/// `least`.
std::optional<Sequence> ClosedRounds::ThroughRaised(const LadderProblem& problem, double least, int raise) {
  const double from = std::max(limit_ / (1 + kMoreThanBefore), least);
  for (; raise <= kRaises; ++raise) {
    if (raise > 0) limit_ = raise < kRaises ? (1 + std::ldexp(kMoreThanBefore, raise)) * from : kInfinity;
    if (least > limit_) continue;
    std::optional<Sequence> found = Through(problem);
    if (!found) continue;
    if (!std::isfinite(limit_)) limit_ = (1 + kMoreThanBefore) * found->cost;
    return found;
  }
  return std::nullopt;
}

void ClosedRounds::GoOnFrom(const LadderProblem& problem, const Sequence& sequence) {
  const std::vector<size_t>& base = problem.layers[0].base;
  const size_t node = sequence.nodes[0];
  first_ = last_ = node;
  while (first_ > 0 && base[first_ - 1] == base[node]) --first_;
  while (last_ < base.size() && base[last_] == base[node]) ++last_;
  limit_ = (1 + kMoreThanBefore) * sequence.cost;
  chosen_at_ = sequence.cost;
  rows_ = {};
  versions_.assign(problem.versions.begin(), problem.versions.end());
  LeastThrough(problem);
}

/// Whether more than a quarter of the layers are not as they were when this was asked last.
bool ClosedRounds::MuchChanged(const LadderProblem& problem) {
  size_t changed = 0;
  for (size_t t = 0; t < versions_.size(); ++t) changed += versions_[t] != problem.versions[t];
  versions_.assign(problem.versions.begin(), problem.versions.end());
  return 4 * changed > versions_.size();
}

/// No sequence through the node costs less. What the rest of one costs from any node on is brought up to
/// date.
double ClosedRounds::LeastThrough(const LadderProblem& problem) {
  to_go_ = &(problem.memory ? *problem.memory : own_).ToGoFor(problem);
  double least = kInfinity;
  for (size_t node = first_; node < last_; ++node)
    least = std::min(least, problem.layers[0].objective[node] + (*to_go_)[0][node]);
  return least;
}

/// The best through the node, if it costs no more than the limit.
std::optional<Sequence> ClosedRounds::Through(const LadderProblem& problem) {
  Sweep sweep(problem, kInfinity);
  sweep.LeaveOutAbove(limit_, *to_go_);
  if (!sweep.Forward(rows_, first_, last_, false)) return std::nullopt;
  const Sweep::Closing closing = sweep.Close(first_, last_);
  // Above the limit it need not be the best: parts of better ones may have been left out.
  if (!std::isfinite(closing.by.cost) || closing.by.cost > limit_) return std::nullopt;
  return sweep.TraceClosed(closing);
}

}  // namespace millpose
