// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/sweep.hpp"

#include <tuple>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "motion/line.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr uint32_t kBreak = 0xffffffffU, kEnter = 0xfffffffeU;

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

}  // namespace

bool Sweep::Forward(SweepRows& rows, size_t first, size_t last, bool breaks) {
  return Forward(rows, first, last, breaks, {});
}

bool Sweep::Forward(SweepRows& rows, size_t first, size_t last, bool breaks, std::vector<double> enter) {
  enter_ = std::move(enter);
  rows_ = &rows;
  rows.layers.resize(layers_.size());
  used_before_.assign(layers_.size(), kNoNode);
  least_before_.assign(layers_.size(), kNoNode);
  least_cost_before_.assign(layers_.size(), kInfinity);
  last_used_ = kNoNode;
  least_ = kInfinity;
  changes_ = {};
  bool must_break = false;
  for (size_t t = 0; t < layers_.size(); ++t) {
    CheckStop(problem_.stop);
    if (!layers_[t].usable()) {
      must_break = true;
      rows.layers[t] = {};
      changes_ = {};
      continue;
    }
    must_break = must_break || (t > 0 && !problem_.break_before.empty() && problem_.break_before[t]);
    if (t == 0) {
      Start(first, last);
    } else {
      Advance(t, breaks, must_break);
    }
    must_break = false;
    if (!breaks && !std::isfinite(least_)) {
      rows.layers.resize(t);  // beyond, nothing is known
      return false;
    }
  }
  return std::isfinite(least_);
}

void Sweep::Start(size_t first, size_t last) {
  std::vector<double> row(layers_[0].size(), kInfinity);
  for (size_t node = first; node < last; ++node) row[node] = Value(layers_[0].objective[node]);
  Take(0, std::move(row));
}

void Sweep::Advance(size_t t, bool breaks, bool must_break) {
  const Layer& layer = layers_[t];
  SweepRows::OfLayer& known = rows_->layers[t];
  used_before_[t] = last_used_;
  least_before_[t] = least_node_;
  least_cost_before_[t] = least_;
  if (last_used_ == kNoNode) {
    known.relaxed.clear();
    std::vector<double> row(layer.size());
    std::ranges::transform(layer.objective, row.begin(), [&](double value) { return Value(value); });
    return Take(t, std::move(row));
  }
  RelaxAll(t, must_break);
  const double enter = enter_.empty() || must_break ? kInfinity : enter_[t];
  std::vector<double> row(layer.size(), kInfinity);
  known.previous.assign(layer.size(), kBreak);
  for (size_t node = 0; node < layer.size(); ++node) {
    if (!std::isfinite(Value(layer.objective[node]))) continue;
    const BestPredecessor& by = known.relaxed[node];
    double cost = by.cost;
    if (breaks && least_ + break_penalty_ < by.cost) {
      cost = least_ + break_penalty_;
    } else if (std::isfinite(by.cost)) {
      known.previous[node] = static_cast<uint32_t>(by.node);
    }
    if (enter < cost) cost = enter, known.previous[node] = kEnter;
    row[node] = Combined(cost, layer.objective[node]);
  }
  Take(t, std::move(row));
}

double Sweep::Value(double objective) const { return objective <= problem_.most ? objective : kInfinity; }

/// The cost of a way on which a node follows. A largest value carries its breaks beside it, as multiples of
/// the penalty, which is larger than any value.
double Sweep::Combined(double cost, double objective) const {
  if (!problem_.worst) return cost + objective;
  const double breaks =
      std::isfinite(break_penalty_) ? std::floor(cost / break_penalty_) * break_penalty_ : 0.0;
  return breaks + std::max(cost - breaks, objective);
}

/// The best predecessors of the nodes of layer t. What is known of a node holds while its predecessor costs
/// what it did, no other costs less, and nothing more was struck out of the layer before.
void Sweep::RelaxAll(size_t t, bool must_break) {
  const Layer& layer = layers_[t];
  SweepRows::OfLayer& known = rows_->layers[t];
  const uint64_t version = problem_.versions.empty() ? 0 : problem_.versions[t - 1];
  const bool holds = known.relaxed.size() == layer.size() && !known.after_break && !must_break &&
                     known.version == version && problem_.most <= known.most && changes_.known &&
                     !changes_.some_less;
  const bool all_hold = holds && !changes_.some;
  known.version = version;
  known.most = problem_.most;
  known.after_break = must_break;
  if (all_hold) return;
  if (!holds) known.relaxed.assign(layer.size(), {});
  if (must_break) return;
  size_t guess = 0;
  for (size_t node = 0; node < layer.size(); ++node) {
    BestPredecessor& by = known.relaxed[node];
    if (!std::isfinite(Value(layer.objective[node]))) {
      by = {};  // nobody asks for it under this bound
      continue;
    }
    if (holds && (!std::isfinite(by.cost) || !changes_.changed[by.node])) continue;
    by = {};
    Relax(t - 1, t, node, guess, by);
    if (std::isfinite(by.cost)) guess = by.node;
  }
}

/// The costs of layer t's nodes are known: what of them has changed, and the least.
void Sweep::Take(size_t t, std::vector<double> row) {
  CostRow& kept = rows_->layers[t].row;
  changes_ = {};
  changes_.known = kept.size() == row.size();
  if (changes_.known) {
    changes_.changed.resize(row.size());
    for (size_t node = 0; node < row.size(); ++node) {
      changes_.changed[node] = row[node] != kept.costs[node];
      changes_.some = changes_.some || changes_.changed[node];
      changes_.some_less = changes_.some_less || row[node] < kept.costs[node];
    }
  }
  last_used_ = t;
  least_ = kInfinity;
  for (size_t node = 0; node < row.size(); ++node) {
    if (row[node] < least_) least_ = row[node], least_node_ = node;
  }
  if (!changes_.known || changes_.some) kept = CostRow(std::move(row));
}

Sweep::Closing Sweep::Close(size_t first, size_t last) const {
  Closing best;
  size_t guess = 0;
  for (size_t node = first; node < last; ++node) {
    BestPredecessor by;
    Relax(layers_.size() - 1, 0, node, guess, by);
    if (std::isfinite(by.cost)) guess = by.node;
    if (by.cost < best.by.cost) best = {by, node};
  }
  return best;
}

Sequence Sweep::Trace(size_t node) const {
  Sequence sequence;
  sequence.nodes.assign(layers_.size(), kNoNode);
  sequence.break_before.assign(layers_.size(), false);
  TraceFrom(node, sequence);
  return sequence;
}

size_t Sweep::TraceBack(size_t t, size_t node, Sequence& sequence) const {
  size_t next = kNoNode;  // the layer after, when it has nodes and is joined to this one
  for (; t != kNoNode; t = used_before_[t]) {
    sequence.nodes[t] = node;
    sequence.cost += layers_[t].objective[node];
    if (next != kNoNode) {
      sequence.cost += StepCost(problem_.RuleFrom(t), layers_[t].joints.At(node),
                                layers_[next].joints.At(sequence.nodes[next]));
    }
    next = t;
    if (used_before_[t] == kNoNode) break;
    const uint32_t by = rows_->layers[t].previous[node];
    if (by == kEnter) {
      sequence.break_before[t] = true;
      return t;
    }
    if (by == kBreak) {
      sequence.break_before[t] = true;
      next = kNoNode;
      node = least_before_[t];
    } else {
      node = by;
    }
  }
  return kNoNode;
}

/// Best predecessor in layer `from` of a node of layer `to`; `guess` is one that may be as good as any.
void Sweep::Relax(size_t from, size_t to, size_t node, size_t guess, BestPredecessor& by) const {
  const Layer& source = layers_[from];
  const Layer& target = layers_[to];
  const CostRow& row = rows_->layers[from].row;
  const int branch = target.BranchOf(node);
  const Joints q = target.joints.At(node);
  const StepRule rule = problem_.RuleFrom(from);
  const double band = Band(from, to);
  VisitBand(source, branch, target.first[node], band, problem_.walls, [&](size_t first, size_t last) {
    double at_most = by.cost;
    // That of the node before and the one after it.
    for (size_t k = guess; k < guess + 2; ++k) {
      if (k < first || k >= last) continue;
      at_most = std::min(at_most, row.costs[k] + StepCost(rule, source.joints.At(k), q));
    }
    RelaxFrom(rule, source.joints, row, first, last, q, at_most, by);
  });
  if (problem_.struck.empty() || !std::isfinite(by.cost)) return;
  const StruckEdges& struck = problem_.struck[from];
  if (!struck.contains({by.node, node})) return;
  // Rare: the best is barred, so look again, one by one.
  by = {};
  VisitBand(source, branch, target.first[node], band, problem_.walls, [&](size_t first, size_t last) {
    for (size_t k = first; k < last; ++k) {
      const double cost = row.costs[k] + StepCost(rule, source.joints.At(k), q);
      if (cost < by.cost && !struck.contains({k, node})) by = {cost, k};
    }
  });
}

double Sweep::Band(size_t from, size_t to) const {
  if (!problem_.banded) return kInfinity;
  if (from != band_from_) {
    band_from_ = from;
    band_ = BandWidth(problem_.RuleFrom(from), AngleBetween(layers_[from].R_WT, layers_[to].R_WT));
  }
  return band_;
}

}  // namespace millpose
