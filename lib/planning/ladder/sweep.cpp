// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/sweep.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

constexpr uint32_t kBreak = 0xffffffffU, kEnter = 0xfffffffeU;

}  // namespace

void Sweep::LeaveOutAbove(double at_most, const ToGo& to_go) {
  limit_ = at_most;
  to_go_ = &to_go;
}

/// Whether a way that costs `cost` up to a node of layer t, this counted, is too dear.
bool Sweep::IsAbove(double cost, size_t t, size_t node) const {
  if (!to_go_) return false;
  return cost + (*to_go_)[At(t)][node] > limit_;
}

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
    if (!layers_[At(t)].usable()) {
      must_break = true;
      rows.layers[t] = {};
      changes_ = {};
      continue;
    }
    must_break = must_break || (t > 0 && !problem_.break_before.empty() && problem_.break_before[At(t)]);
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
  const Layer& layer = layers_[At(0)];
  row_.assign(layer.size(), kInfinity);
  for (size_t node = first; node < last; ++node) {
    row_[node] = Value(layer.objective[node]);
    if (IsAbove(row_[node], 0, node)) row_[node] = kInfinity;
  }
  Take(0);
}

void Sweep::Advance(size_t t, bool breaks, bool must_break) {
  const Layer& layer = layers_[At(t)];
  SweepRows::OfLayer& known = rows_->layers[t];
  used_before_[t] = last_used_;
  least_before_[t] = least_node_;
  least_cost_before_[t] = least_;
  if (last_used_ == kNoNode) {
    known.relaxed.clear();
    row_.resize(layer.size());
    std::ranges::transform(layer.objective, row_.begin(), [&](double value) { return Value(value); });
    return Take(t);
  }
  RelaxAll(t, must_break);
  const double enter = enter_.empty() || must_break ? kInfinity : enter_[t];
  row_.assign(layer.size(), kInfinity);
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
    row_[node] = Combined(cost, layer.objective[node]);
    if (IsAbove(row_[node], t, node)) row_[node] = kInfinity;
  }
  Take(t);
}

double Sweep::Value(double objective) const { return objective <= problem_.most ? objective : kInfinity; }

/// What the way to a node's predecessor with the step may cost, so that the node is not left out.
double Sweep::MostBefore(size_t t, size_t node) const {
  constexpr double kRounding = 1e-12;
  if (!std::isfinite(limit_)) return kInfinity;
  return (1 + kRounding) * limit_ - layers_[At(t)].objective[node] - (*to_go_)[At(t)][node];
}

/// The cost of a way on which a node follows. A largest value carries its breaks beside it, as multiples of
/// the penalty, which is larger than any value.
double Sweep::Combined(double cost, double objective) const {
  if (!problem_.worst) return cost + objective;
  const double breaks =
      std::isfinite(break_penalty_) ? std::floor(cost / break_penalty_) * break_penalty_ : 0.0;
  return breaks + std::max(cost - breaks, objective);
}

/// The best predecessors of the nodes of layer t. What is known of a node holds while its predecessor costs
/// what it did, no other costs less, and nothing more was pruned of the layer before.
void Sweep::RelaxAll(size_t t, bool must_break) {
  const Layer& layer = layers_[At(t)];
  SweepRows::OfLayer& known = rows_->layers[t];
  const uint64_t version = problem_.versions.empty() ? 0 : problem_.versions[At(t - 1)];
  const bool holds = known.relaxed.size() == layer.size() && !known.after_break && !must_break &&
                     known.version == version && problem_.most <= known.most && limit_ <= known.limit &&
                     changes_.known && !changes_.some_less;
  const bool all_hold = holds && !changes_.some;
  known.version = version;
  known.most = problem_.most;
  known.limit = limit_;
  known.after_break = must_break;
  if (all_hold) return;
  if (!holds) known.relaxed.assign(layer.size(), {});
  if (must_break) return;
  wanted_.assign(layer.size(), 0);
  const std::vector<double>& costs = rows_->layers[t - 1].row.costs;
  const std::vector<size_t>&lanes = layer.lane_begin, &lanes_before = layers_[At(t - 1)].lane_begin;
  for (size_t lane = 0; lane + 1 < lanes.size(); ++lane) {
    double least = kInfinity;
    for (size_t node = lanes_before[lane]; node < lanes_before[lane + 1]; ++node)
      least = std::min(least, costs[node]);
    for (size_t node = lanes[lane]; node < lanes[lane + 1]; ++node) {
      BestPredecessor& by = known.relaxed[node];
      const double objective = layer.objective[node];
      if (!std::isfinite(least) || !std::isfinite(Value(objective)) ||
          IsAbove(Combined(least, objective), t, node)) {
        by = {};  // nobody asks for it under these bounds
        continue;
      }
      wanted_[node] = static_cast<char>(!holds || (std::isfinite(by.cost) && changes_.changed[by.node] != 0));
      if (wanted_[node] != 0) by.cost = MostBefore(t, node);
    }
  }
  StepsFrom(t - 1, t).Relax(rows_->layers[t - 1].row, wanted_, known.relaxed);
}

/// The costs of layer t's nodes are known: what of them has changed, and the least.
void Sweep::Take(size_t t) {
  CostRow& kept = rows_->layers[t].row;
  changes_.some = changes_.some_less = false;
  changes_.known = kept.size() == row_.size();
  if (changes_.known) {
    changes_.changed.resize(row_.size());
    for (size_t node = 0; node < row_.size(); ++node) {
      changes_.changed[node] = row_[node] != kept.costs[node];
      changes_.some = changes_.some || changes_.changed[node];
      changes_.some_less = changes_.some_less || row_[node] < kept.costs[node];
    }
  }
  last_used_ = t;
  least_ = kInfinity;
  for (size_t node = 0; node < row_.size(); ++node) {
    if (row_[node] < least_) least_ = row_[node], least_node_ = node;
  }
  if (!changes_.known || changes_.some) kept.Set(row_);
}

Sweep::Closing Sweep::Close(size_t first, size_t last) const {
  const size_t end = layers_.size() - 1;
  std::vector<char> wanted(layers_[At(0)].size());
  std::fill(wanted.begin() + static_cast<std::ptrdiff_t>(first),
            wanted.begin() + static_cast<std::ptrdiff_t>(last), 1);
  std::vector<BestPredecessor> into(wanted.size());
  StepsFrom(end, 0).Relax(rows_->layers[end].row, wanted, into);
  Closing best;
  for (size_t node = first; node < last; ++node)
    if (into[node].cost < best.by.cost) best = {into[node], node};
  return best;
}

Sequence Sweep::Trace(size_t node) const {
  Sequence sequence;
  sequence.nodes.assign(layers_.size(), kNoNode);
  sequence.break_before.assign(layers_.size(), false);
  TraceFrom(node, sequence);
  return sequence;
}

Sequence Sweep::TraceClosed(const Closing& closing) const {
  Sequence sequence = Trace(closing.by.node);
  sequence.cost = closing.by.cost;
  sequence.closed = true;
  return sequence;
}

size_t Sweep::TraceBack(size_t t, size_t node, Sequence& sequence) const {
  size_t next = kNoNode;  // the layer after, when it has nodes and is joined to this one
  for (; t != kNoNode; t = used_before_[t]) {
    const size_t at = At(t);
    sequence.nodes[at] = node;
    sequence.cost += layers_[at].objective[node];
    if (next != kNoNode) {
      sequence.cost += StepCost(problem_.RuleFrom(at), layers_[at].joints.At(node),
                                layers_[At(next)].joints.At(sequence.nodes[At(next)]));
    }
    next = t;
    if (used_before_[t] == kNoNode) break;
    const uint32_t by = rows_->layers[t].previous[node];
    if (by == kEnter) {
      sequence.break_before[at] = true;
      return t;
    }
    if (by == kBreak) {
      sequence.break_before[at] = true;
      next = kNoNode;
      node = least_before_[t];
    } else {
      node = by;
    }
  }
  return kNoNode;
}

/// The steps from a layer to the next, or from the last to the first.
LayerSteps Sweep::StepsFrom(size_t from, size_t to) const {
  const Layer &source = layers_[At(from)], &target = layers_[At(to)];
  const StepRule rule = problem_.RuleFrom(At(from));
  return {source,
          target,
          {rule, BandBetween(problem_, rule, source, target), problem_.walls,
           problem_.blocked.empty() ? nullptr : &problem_.blocked[At(from)]}};
}

}  // namespace millpose
