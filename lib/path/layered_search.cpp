// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/layered_search.hpp"

#include <queue>
#include <tuple>

#include "base/parallel.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr uint32_t kBreak = 0xffffffffU;

double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle();
}

/// Nodes between `begin` and `end` that can be reached from the place `at` without leaping over one that was
/// struck out; where `at` itself is in a struck stretch, from both its sides.
std::pair<size_t, size_t> WithinWalls(const Layer& layer, size_t begin, size_t end, size_t at) {
  const auto struck = [&](size_t node) { return !std::isfinite(layer.objective[node]); };
  size_t first = at, last = at;
  while (first > begin && struck(first - 1)) --first;
  while (first > begin && !struck(first - 1)) --first;
  while (last < end && struck(last)) ++last;
  while (last < end && !struck(last)) ++last;
  return {first, last};
}

/// Calls `visit(first, last)` for the ranges of nodes of `branch` whose first freedom lies within `band` of
/// `value`, round the turn too; with `walls` as LayeredProblem says.
template <typename Visit>
void VisitBand(const Layer& layer, int branch, double value, double band, bool walls, const Visit& visit) {
  const auto begin = layer.first.begin();
  const size_t from = layer.branch_begin[branch], to = layer.branch_begin[branch + 1];
  if (band >= kPi && !walls) return visit(from, to);
  const auto part = [&](double middle) {
    size_t first = static_cast<size_t>(std::lower_bound(begin + from, begin + to, middle - band) - begin);
    size_t last = static_cast<size_t>(std::upper_bound(begin + first, begin + to, middle + band) - begin);
    if (walls) {
      const size_t at = static_cast<size_t>(std::lower_bound(begin + first, begin + last, middle) - begin);
      std::tie(first, last) = WithinWalls(layer, first, last, at);
    }
    if (first != last) visit(first, last);
  };
  part(value);
  if (value - band < -kPi) part(value + 2 * kPi);
  if (value + band > kPi) part(value - 2 * kPi);
}

/// One sweep of the dynamic programme.
class Sweep {
 public:
  Sweep(const LayeredProblem& problem, double break_penalty)
      : problem_(problem), layers_(problem.layers), break_penalty_(break_penalty) {}

  /// Starts with the nodes first..last−1 of layer 0. False when the last layer cannot be reached; with
  /// `breaks` it always can.
  bool Forward(size_t first, size_t last, bool breaks) {
    previous_.assign(layers_.size(), {});
    Start(first, last);
    for (size_t t = 1; t < layers_.size(); ++t) {
      CheckStop(problem_.stop);
      if (!layers_[t].usable()) {
        must_break_ = true;
        continue;
      }
      must_break_ = must_break_ || (!problem_.break_before.empty() && problem_.break_before[t]);
      Advance(t, breaks);
      if (!breaks && !std::isfinite(least_)) return false;
    }
    return std::isfinite(least_);
  }

  /// Cheapest way to close into one of the nodes first..last−1 of layer 0; its cost is that of the whole
  /// cycle.
  struct Closing {
    BestPredecessor by;
    size_t into = kNoNode;
  };
  Closing Close(size_t first, size_t last) const {
    Closing best;
    for (size_t node = first; node < last; ++node) {
      BestPredecessor by;
      Relax(layers_.size() - 1, 0, node, by);
      if (by.cost < best.by.cost) best = {by, node};
    }
    return best;
  }

  size_t least_node() const { return least_node_; }

  /// The sequence that ends in `node` of the last layer that has nodes.
  Sequence Trace(size_t node) const {
    Sequence sequence;
    sequence.nodes.assign(layers_.size(), kNoNode);
    sequence.break_before.assign(layers_.size(), false);
    size_t next = kNoNode;  // the layer after, when it has nodes and is joined to this one
    for (size_t t = last_used_; t != kNoNode; t = used_before_[t]) {
      sequence.nodes[t] = node;
      sequence.cost += layers_[t].objective[node];
      if (next != kNoNode) {
        sequence.cost += StepCost(problem_.rule, layers_[t].joints.At(node),
                                  layers_[next].joints.At(sequence.nodes[next]));
      }
      next = t;
      if (used_before_[t] == kNoNode) break;
      const uint32_t by = previous_[t][node];
      if (by == kBreak) {
        sequence.break_before[t] = true;
        next = kNoNode;
        node = least_before_[t];
      } else {
        node = by;
      }
    }
    return sequence;
  }

 private:
  void Start(size_t first, size_t last) {
    used_before_.assign(layers_.size(), kNoNode);
    least_before_.assign(layers_.size(), kNoNode);
    last_used_ = kNoNode;
    must_break_ = false;
    least_ = kInfinity;
    if (!layers_[0].usable()) return;
    row_.assign(layers_[0].size() + kLanes, kInfinity);
    for (size_t node = first; node < last; ++node) row_[node] = layers_[0].objective[node];
    FindLeast(0);
  }

  void Advance(size_t t, bool breaks) {
    const Layer& layer = layers_[t];
    std::vector<double> next(layer.size() + kLanes, kInfinity);
    previous_[t].assign(layer.size(), kBreak);
    used_before_[t] = last_used_;
    least_before_[t] = least_node_;
    if (last_used_ == kNoNode) {
      std::copy(layer.objective.begin(), layer.objective.end(), next.begin());
    } else {
      for (size_t node = 0; node < layer.size(); ++node) {
        if (!std::isfinite(layer.objective[node])) continue;
        BestPredecessor by;
        if (!must_break_) Relax(t - 1, t, node, by);
        if (breaks && least_ + break_penalty_ < by.cost) {
          by.cost = least_ + break_penalty_;
        } else if (std::isfinite(by.cost)) {
          previous_[t][node] = static_cast<uint32_t>(by.node);
        }
        next[node] = by.cost + layer.objective[node];
      }
    }
    row_ = std::move(next);
    must_break_ = false;
    FindLeast(t);
  }

  void FindLeast(size_t t) {
    last_used_ = t;
    least_ = kInfinity;
    for (size_t node = 0; node < layers_[t].size(); ++node) {
      if (row_[node] < least_) least_ = row_[node], least_node_ = node;
    }
  }

  /// Best predecessor in layer `from` (whose costs are in row_) of a node of layer `to`.
  void Relax(size_t from, size_t to, size_t node, BestPredecessor& by) const {
    const Layer& source = layers_[from];
    const Layer& target = layers_[to];
    const int branch = target.BranchOf(node);
    const Joints q = target.joints.At(node);
    const double band = Band(from, to);
    VisitBand(source, branch, target.first[node], band, problem_.walls, [&](size_t first, size_t last) {
      RelaxFrom(problem_.rule, source.joints, row_, first, last, q, by);
    });
    if (problem_.struck.empty() || !std::isfinite(by.cost)) return;
    const StruckEdges& struck = problem_.struck[from];
    if (!struck.contains({by.node, node})) return;
    // Rare: the best is barred, so look again, one by one.
    by = {};
    VisitBand(source, branch, target.first[node], band, problem_.walls, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        const double cost = row_[k] + StepCost(problem_.rule, source.joints.At(k), q);
        if (cost < by.cost && !struck.contains({k, node})) by = {cost, k};
      }
    });
  }

  double Band(size_t from, size_t to) const {
    if (!problem_.banded) return kInfinity;
    if (from != band_from_) {
      band_from_ = from;
      band_ = BandWidth(problem_.rule, AngleBetween(layers_[from].R_WT, layers_[to].R_WT));
    }
    return band_;
  }

  const LayeredProblem& problem_;
  std::span<const Layer> layers_;
  double break_penalty_;
  std::vector<double> row_;
  std::vector<std::vector<uint32_t>> previous_;
  std::vector<size_t> used_before_, least_before_;
  size_t last_used_ = kNoNode, least_node_ = 0;
  double least_ = kInfinity;
  bool must_break_ = false;
  mutable size_t band_from_ = kNoNode;
  mutable double band_ = 0;
};

/// More than any sequence can cost, so that one break less always wins.
double BreakPenalty(const LayeredProblem& problem) {
  double sum = 0.0;
  for (const Layer& layer : problem.layers) {
    double least = kInfinity, most = -kInfinity;
    for (const double value : layer.objective) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    if (most > least) sum += most - least;
    sum += problem.rule.motion_weight * problem.rule.max_step.squaredNorm();
  }
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

Sequence SearchOpen(const LayeredProblem& problem) {
  Sequence none;
  none.nodes.assign(problem.layers.size(), kNoNode);
  none.break_before.assign(problem.layers.size(), false);
  if (problem.layers.empty()) return none;
  Sweep sweep(problem, BreakPenalty(problem));
  if (!sweep.Forward(0, problem.layers[0].size(), true)) return none;
  return sweep.Trace(sweep.least_node());
}

std::optional<Sequence> SearchClosed(const LayeredProblem& problem, int max_sweeps) {
  for (const Layer& layer : problem.layers) {
    if (!layer.usable()) return std::nullopt;
  }
  Sweep sweep(problem, kInfinity);
  const std::vector<size_t>& base = problem.layers[0].base;
  std::optional<Sequence> best;
  std::priority_queue<Part, std::vector<Part>, Costlier> open;
  const auto bound = [&](size_t first, size_t last) {
    if (first >= last || --max_sweeps < 0 || !sweep.Forward(first, last, false)) return;
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
