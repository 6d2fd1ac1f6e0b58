// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/least_worst_ring.hpp"

#include "base/units.hpp"
#include "planning/ladder/returning.hpp"
#include "planning/ladder/sweep.hpp"
#include "planning/ladder/worst_then_sum.hpp"

namespace millpose {
namespace {

// The next bound to try above one that was too low: so many times as high, and beyond a share of the values.
constexpr double kHigher = 1.4;
constexpr size_t kShare = 16;

/// The best closed sequence through one node of a layer, in searches over the same layers with ever more
/// pruned.
class ThroughNode {
 public:
  ThroughNode() = default;
  /// Through one of the nodes first..last−1 of a layer.
  ThroughNode(size_t layer, NodeRange nodes) : layer_(layer), nodes_(nodes) {}

  /// From now on through one of fewer nodes.
  void Narrow(NodeRange nodes) { nodes_ = nodes; }
  /// Afterwards, the node of the layer into which the sequence closes.
  size_t into() const { return into_; }

  std::optional<Sequence> Search(LadderProblem problem) {
    if (nodes_.first == nodes_.second) return std::nullopt;
    problem.first_layer = layer_;
    Sweep sweep(problem, kInfinity);
    if (!sweep.Forward(rows_, nodes_.first, nodes_.second, false)) return std::nullopt;
    const Sweep::Closing closing = sweep.Close(nodes_.first, nodes_.second);
    if (!std::isfinite(closing.by.cost)) return std::nullopt;
    into_ = closing.into;
    return sweep.TraceClosed(closing);
  }

 private:
  size_t layer_ = 0, into_ = kNoNode;
  NodeRange nodes_{0, 0};
  SweepRows rows_;
};

class RingBisection {
 public:
  RingBisection(const LadderProblem& problem, const RingTrials& trials)
      : problem_(problem), trials_(trials), none_within_(CountLanes(problem), -kInfinity) {}

  std::optional<Sequence> Run() {
    while (const std::optional<double> bound = Next()) {
      if (std::optional<Sequence> found = FreeWithin(*bound)) {
        best_ = std::move(found);
        high_ = WorstOf(problem_.layers, *best_);
        asked_ = false;
      } else {
        low_ = *bound;
      }
    }
    return std::move(best_);
  }

 private:
  /// A free sequence within the bound, if there is one.
  std::optional<Sequence> FreeWithin(double bound) {
    for (int round = 0;; ++round) {
      std::optional<Sequence> found = trials_.search([&] { return Search(Within(problem_, bound)); });
      if (!found || trials_.is_free(*found, round)) return found;
    }
  }

  /// Some closed sequence, if there is one.
  std::optional<Sequence> Search(const LadderProblem& problem) {
    if (!std::ranges::all_of(problem.layers, &Layer::usable)) return std::nullopt;
    std::optional<Sequence> found = through_.Search(problem);
    if (found) return found;
    for (size_t lane = 0; lane < none_within_.size(); ++lane) {
      const ReturningNodes nodes = Returning(problem, lane);
      if (nodes.ranges.empty()) continue;
      ThroughNode through = ChooseAmong(nodes, problem);
      std::optional<Sequence> other = through.Search(problem);
      if (!other || (found && !(other->cost < found->cost))) continue;
      through_ = std::move(through);
      found = std::move(other);
    }
    return found;
  }

  /// What was pruned stays so: where a lane has none within a bound, it has none within a smaller one.
  ReturningNodes Returning(const LadderProblem& problem, size_t lane) {
    if (problem.most <= none_within_[lane]) return {};
    ReturningNodes nodes = FindReturning(problem, lane);
    if (nodes.ranges.empty()) none_within_[lane] = problem.most;
    return nodes;
  }

  bool Closes(double bound) {
    for (size_t lane = 0; lane < none_within_.size(); ++lane)
      if (!Returning(Within(problem_, bound), lane).ranges.empty()) return true;
    return false;
  }

  /// One of the nodes: through which the least from any into any of them closes, or near where it does.
  static ThroughNode ChooseAmong(const ReturningNodes& nodes, const LadderProblem& problem) {
    ThroughNode through(nodes.layer, {nodes.ranges.front().first, nodes.ranges.back().second});
    through.Search(problem);
    const size_t into = through.into();
    const auto near =
        std::ranges::find_if(nodes.ranges, [&](const NodeRange& range) { return into < range.second; });
    through.Narrow(near == nodes.ranges.end() ? nodes.ranges.front() : *near);
    return through;
  }

  /// The bound to try next; none where the best that was found has the least worst value.
  std::optional<double> Next() {
    std::vector<double> values = PossibleBounds(problem_, high_);
    const auto tried = [&](double value) { return value <= low_ * (1 + kWorstTolerance); };
    values.erase(values.begin(), std::ranges::partition_point(values, tried));
    while (!values.empty() && values.back() * (1 + kWorstTolerance) >= high_) values.pop_back();
    if (values.empty()) return std::nullopt;
    if (best_) {
      // Often none is better: that is soon told.
      if (!std::exchange(asked_, true) && !Closes(values.back())) return std::nullopt;
      return values[(values.size() - 1) / 2];
    }
    if (!std::isfinite(low_)) return values.front();
    const auto lower = [&](double value) { return value < kHigher * low_; };
    const auto next = static_cast<size_t>(std::ranges::partition_point(values, lower) - values.begin());
    return values[std::clamp(next, values.size() / kShare, values.size() - 1)];
  }

  const LadderProblem& problem_;
  const RingTrials& trials_;
  ThroughNode through_;
  std::vector<double> none_within_;  ///< per lane: the largest bound within which it has none
  double low_ = -kInfinity;          ///< within it there is none that is free
  double high_ = kInfinity;          ///< worst value of the best
  std::optional<Sequence> best_;
  bool asked_ = false;  ///< whether there is any that is better than the best
};

}  // namespace

std::optional<Sequence> SearchLeastWorstRing(const LadderProblem& problem, const RingTrials& trials) {
  return RingBisection(problem, trials).Run();
}

}  // namespace millpose
