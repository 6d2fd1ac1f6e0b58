// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/end_guard.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

/// Layers of a pass that are given up for this. Then its piece is left to the gaps, which leave it out.
constexpr int kMostLost = 8;
/// Nodes that are looked at together, and nodes with a free retract that are enough for the next search.
constexpr size_t kBatch = 16, kEnough = 16;

}  // namespace

bool EndGuard::Check(const Sequence& sequence) {
  const std::vector<size_t> ends = EndsOf(sequence);
  std::vector<char> stuck(ends.size(), 0);
  graph_.InParallel(ends.size(), [&](PassCheckers& checkers, size_t i) {
    if (ShareAt(ends[i]) == kClearanceShares.front())
      stuck[i] = !Leaves(checkers.At(ends[i]), ends[i], sequence.nodes[ends[i]]);
  });
  for (size_t i = 0; i < ends.size(); ++i)
    if (ShareAt(ends[i]) != kClearanceShares.front())
      stuck[i] = WithLeast(ends[i], {sequence.nodes[ends[i]]})[0] == 0;
  bool free = true;
  for (size_t i = 0; i < ends.size(); ++i) {
    if (!stuck[i]) continue;
    PruneWhatStays(ends[i], sequence.nodes[ends[i]]);
    free = false;
  }
  return free;
}

std::vector<size_t> EndGuard::EndsOf(const Sequence& sequence) const {
  const size_t count = graph_.size();
  const auto over = [&](size_t t) {  // nothing goes on from layer t−1 to layer t
    return t == 0 || t == count || sequence.nodes[t - 1] == kNoNode || sequence.nodes[t] == kNoNode ||
           (!break_before_.empty() && break_before_[t]);
  };
  std::vector<size_t> ends;
  for (size_t t = 0; t < count; ++t) {
    if (sequence.nodes[t] == kNoNode || settled_[t]) continue;
    if (sequence.closed ? t == 0 : over(t) || over(t + 1)) ends.push_back(t);
  }
  return ends;
}

double EndGuard::ShareAt(size_t layer) const {
  return asked_[layer] ? asked_[layer]->share : kClearanceShares.front();
}

bool EndGuard::Leaves(Checker& checker, size_t layer, size_t node) const {
  const Joints q = graph_.layer(layer).joints.At(node);
  return CanLeave(checker, graph_.checks().CarrierAt(layer), q, options_);
}

std::vector<char> EndGuard::WithLeast(size_t layer, const std::vector<size_t>& nodes) {
  Checker least(graph_.checks().WorldAt(layer), kClearanceShares.back());
  std::vector<char> leaves;
  for (const size_t node : nodes) {
    CheckStop(graph_.checks().stop);
    leaves.push_back(Leaves(least, layer, node));
  }
  graph_.Count(least.counts());
  return leaves;
}

/// The layer's nodes as they are asked: the best first, since one of them is likely chosen next.
std::vector<size_t> EndGuard::InOrder(size_t layer) const {
  const std::vector<double>& objective = graph_.layer(layer).objective;
  std::vector<size_t> order;
  for (size_t k = 0; k < objective.size(); ++k)
    if (std::isfinite(objective[k])) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](size_t k) { return objective[k]; });
  return order;
}

void EndGuard::AskOn(size_t layer, Asked& asked) {
  size_t leaving = 0;
  while (asked.next < asked.order.size() && leaving < kEnough) {
    std::vector<size_t> batch;
    graph_.InParallel(1, [&](PassCheckers& checkers, size_t) {
      for (; asked.next < asked.order.size() && batch.size() < kBatch; ++asked.next)
        if (graph_.IsFree(checkers, layer, asked.order[asked.next])) batch.push_back(asked.order[asked.next]);
    });
    std::vector<char> leaves(batch.size(), 0);
    if (asked.share == kClearanceShares.front())
      graph_.InParallel(batch.size(), [&](PassCheckers& checkers, size_t i) {
        leaves[i] = Leaves(checkers.At(layer), layer, batch[i]);
      });
    else
      leaves = WithLeast(layer, batch);
    for (size_t i = 0; i < batch.size(); ++i)
      if (leaves[i])
        ++leaving;
      else
        asked.stuck.push_back(batch[i]);
  }
  asked.any = asked.any || leaving > 0;
}

void EndGuard::PruneWhatStays(size_t layer, size_t node) {
  std::optional<Asked>& asked = asked_[layer];
  const double share = ShareAt(layer);  // with which `node` cannot be left
  if (!asked) {
    if (lost_ == kMostLost) {
      settled_[layer] = 1;
      return;
    }
    asked = Asked{InOrder(layer), share};
  }
  AskOn(layer, *asked);
  if (!asked->any && asked->share != kClearanceShares.back()) {
    asked = Asked{InOrder(layer), kClearanceShares.back()};
    AskOn(layer, *asked);
  }
  if (asked->next == asked->order.size()) settled_[layer] = 1;
  if (!asked->any) {
    ++lost_;
    Checker least(graph_.checks().WorldAt(layer), kClearanceShares.back());
    const Carrier& carrier = graph_.checks().CarrierAt(layer);
    const Joints q = graph_.layer(layer).joints.At(node);
    const JointLimits limits = LimitsAround(carrier.arm, options_.limit_margin, q);
    detail_[layer] =
        "no pose here can be entered or left: " + FindRetract(least, carrier, q, limits, options_).problem;
  }
  for (const size_t k : asked->stuck) graph_.TakeOut(layer, k);
  asked->stuck.clear();
  if (asked->share == share) graph_.TakeOut(layer, node);  // which may stand far down in the order
}

}  // namespace millpose
