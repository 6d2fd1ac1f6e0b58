// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.hpp"
#include "planning/ladder/first_node.hpp"
#include "planning/ladder/returning.hpp"
#include "planning/ladder/sweep.hpp"

namespace millpose {
namespace {

// So many sweeps or fewer ask for any good sequence.
constexpr int kQuick = 16;
// Limits that are tried one after the other, shares above the bound.
constexpr std::array<double, 5> kMore{0.005, 0.02, 0.08, 0.32, kInfinity};
// Share of the best that a better sequence may cost: sums differ by less for their order.
constexpr double kLess = 1 - 1e-9;

/// Nodes first..last−1 of a layer that differ by full revolutions only.
struct Group {
  size_t first, last;
  double bound;  ///< no closed sequence through it costs less
};

class ClosedSearch {
 public:
  ClosedSearch(const LadderProblem& problem, int max_sweeps, double below)
      : problem_(problem), sweeps_(max_sweeps), below_(below) {
    if (!problem_.memory) problem_.memory = &own_;
  }

  std::optional<Sequence> Run() {
    const size_t all = problem_.layers[0].size();
    const ToGo& to_go = problem_.memory->ToGoFor(problem_);
    // What another limit has left out is of no use to the next search.
    SweepRows own;
    SweepRows& rows = std::isfinite(below_) ? own : problem_.memory->RowsFor(0, all);
    Sweep sweep(problem_, kInfinity);
    sweep.LeaveOutAbove(below_, to_go);
    --sweeps_;
    if (!sweep.Forward(rows, 0, all, false)) return std::nullopt;
    const Sweep::Closing closing = sweep.Close(0, all);
    const double least = closing.by.cost;
    if (!(least < below_)) return std::nullopt;
    const auto through = [&](size_t t, size_t node) {
      return rows.layers[t].row.costs[node] + to_go[t][node];
    };
    // What costs little more than the bound is found without looking at most nodes.
    for (const double more : kMore) {
      limit_ = std::min(below_, (1 + more) * least);
      TryAll(through);
      if (best_ || sweeps_ <= 0 || limit_ == below_) break;
    }
    return std::move(best_);
  }

 private:
  /// Tries the nodes of the layer through which fewest can lead to a better sequence. `through`: what closed
  /// sequences through a node of a layer cost at the least.
  template <typename Through>
  void TryAll(const Through& through) {
    NodeMask counted(problem_.layers.size());
    std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
    size_t layer = 0;
    for (size_t t = 0; t < counted.size(); ++t) {
      counted[t].resize(problem_.layers[t].size());
      for (size_t node = 0; node < counted[t].size(); ++node) counted[t][node] = through(t, node) < limit_;
      const std::ptrdiff_t count = std::ranges::count(counted[t], 1);
      if (count < fewest) fewest = count, layer = t;
    }
    std::vector<Group> groups;
    for (size_t node = 0; node < problem_.layers[layer].size();) {
      Group group = GroupOf(layer, node);
      for (size_t k = group.first; k < group.last; ++k)
        group.bound = std::min(group.bound, through(layer, k));
      node = group.last;
      if (group.bound < limit_) groups.push_back(group);
    }
    problem_.first_layer = layer;
    KeepReturning(counted, groups);
    if (!groups.empty()) {
      BackwardRows rows;
      const ToGo& to_go = LeastToGo(problem_, counted, rows);
      for (const std::span<const Group> set : SetsOf(groups)) TrySet(set, to_go);
    }
    problem_.first_layer = 0;
  }

  /// Leaves out those that no sequence comes back to: where closed ones are rare, nearly all.
  void KeepReturning(const NodeMask& counted, std::vector<Group>& groups) const {
    constexpr size_t kFew = 4;  // are soon tried
    if (groups.size() <= kFew) return;
    std::vector<NodeRange> ranges;
    for (const Group& group : groups) ranges.emplace_back(group.first, group.last);
    const std::vector<char> returning = AreReturning(problem_, ranges, counted);
    size_t i = 0;
    std::erase_if(groups, [&](const Group&) { return returning[i++] == 0; });
  }

  static double BoundOf(std::span<const Group> set) { return std::ranges::min(set, {}, &Group::bound).bound; }

  /// Neighbouring groups in sets, the one with the least bound first.
  static std::vector<std::span<const Group>> SetsOf(const std::vector<Group>& groups) {
    constexpr size_t kMost = 32;
    std::vector<std::span<const Group>> sets;
    for (size_t i = 0; i < groups.size();) {
      size_t end = i + 1;
      while (end < groups.size() && end - i < kMost && groups[end].first == groups[end - 1].last) ++end;
      sets.emplace_back(groups.data() + i, end - i);
      i = end;
    }
    std::ranges::stable_sort(sets, {}, &BoundOf);
    return sets;
  }

  /// The closed sequence of least cost through one of the groups, if it is better than the best. A way round
  /// from any of them into any of them bounds it; where that does not come back to its own group, each half
  /// of the set is tried.
  void TrySet(std::span<const Group> set, const ToGo& to_go) {
    if (!(BoundOf(set) < limit_) || --sweeps_ < 0) return;
    const size_t first = set.front().first, last = set.back().last;
    Sweep sweep(problem_, kInfinity);
    sweep.LeaveOutAbove(limit_, to_go);
    SweepRows rows;
    if (!sweep.Forward(rows, first, last, false)) return;
    const Sweep::Closing closing = sweep.Close(first, last);
    if (!(closing.by.cost < limit_)) return;
    Sequence sequence = sweep.TraceClosed(closing);
    const std::vector<size_t>& base = problem_.layers[problem_.first_layer].base;
    if (base[sequence.nodes[problem_.first_layer]] == base[closing.into]) {
      best_ = std::move(sequence);
      limit_ = closing.by.cost * kLess;
      return;
    }
    const std::span<const Group> left = set.first(set.size() / 2), right = set.subspan(set.size() / 2);
    const bool left_first = BoundOf(left) <= BoundOf(right);
    TrySet(left_first ? left : right, to_go);
    TrySet(left_first ? right : left, to_go);
  }

  Group GroupOf(size_t layer, size_t node) const {
    const std::vector<size_t>& base = problem_.layers[layer].base;
    Group group{node, node + 1, kInfinity};
    while (group.first > 0 && base[group.first - 1] == base[node]) --group.first;
    while (group.last < base.size() && base[group.last] == base[node]) ++group.last;
    return group;
  }

  LadderProblem problem_;
  SweepMemory own_;
  int sweeps_;
  double below_;
  double limit_ = kInfinity;  ///< what a sequence must cost less than
  std::optional<Sequence> best_;
};

/// The cheapest way round from one of the nodes first..last−1 of the first layer into one of them, if it
/// costs no more than `at_most`.
std::optional<Round> CheapestRound(const LadderProblem& problem, const ToGo& to_go, size_t first, size_t last,
                                   double at_most) {
  double least = kInfinity;
  for (size_t node = first; node < last; ++node)
    least = std::min(least, problem.layers[0].objective[node] + to_go[0][node]);
  for (const double more : kMore) {
    const double limit = std::min(at_most, (1 + more) * least);
    if (!(least <= limit) || !std::isfinite(least)) return std::nullopt;
    Sweep sweep(problem, kInfinity);
    sweep.LeaveOutAbove(limit, to_go);
    SweepRows rows;
    if (sweep.Forward(rows, first, last, false)) {
      const Sweep::Closing closing = sweep.Close(first, last);
      // Above the limit it need not be the cheapest: parts of cheaper ones may have been left out.
      if (std::isfinite(closing.by.cost) && closing.by.cost <= limit)
        return Round{closing.by.cost, closing.into, sweep.Trace(closing.by.node)};
    }
    if (limit == at_most) return std::nullopt;
  }
  return std::nullopt;
}

/// Some good sequence, by branch and bound over the nodes of the first layer.
std::optional<Sequence> SearchQuickly(const LadderProblem& problem, int max_sweeps) {
  SweepMemory own;
  const ToGo& to_go = (problem.memory ? *problem.memory : own).ToGoFor(problem);
  const std::vector<size_t>& base = problem.layers[0].base;
  double best = kInfinity;  // that is closed
  const auto round = [&](size_t first, size_t last) {
    std::optional<Round> found = CheapestRound(problem, to_go, first, last, best);
    if (found && base[found->sequence.nodes[0]] == base[found->into]) best = std::min(best, found->cost);
    return found;
  };
  return BranchOverFirst(base, round, max_sweeps);
}

}  // namespace

std::optional<Sequence> SearchClosed(const LadderProblem& problem, int max_sweeps, double below) {
  for (const Layer& layer : problem.layers)
    if (!layer.usable()) return std::nullopt;
  if (max_sweeps <= kQuick) return SearchQuickly(problem, max_sweeps);
  return ClosedSearch(problem, max_sweeps, below).Run();
}

}  // namespace millpose
