// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/end_guard.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

/// Layers of a pass that are given up for this. Then its piece is left to the gaps, which leave it out.
constexpr int kMostLost = 8;

}  // namespace

bool EndGuard::Check(const Sequence& sequence) {
  const std::vector<size_t> ends = EndsOf(sequence);
  std::vector<char> stuck(ends.size(), 0);
  graph_.InParallel(ends.size(), [&](PassCheckers& checkers, size_t i) {
    const Joints q = graph_.layer(ends[i]).joints.At(sequence.nodes[ends[i]]);
    stuck[i] = !CanLeave(checkers.At(ends[i]), graph_.checks().CarrierAt(ends[i]), q, options_);
  });
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

void EndGuard::PruneWhatStays(size_t layer, size_t node) {
  settled_[layer] = 1;
  if (lost_ == kMostLost) return;
  const Layer& of = graph_.layer(layer);
  const Carrier& carrier = graph_.checks().CarrierAt(layer);
  std::vector<size_t> free;
  graph_.InParallel(1, [&](PassCheckers& checkers, size_t) {
    for (size_t k = 0; k < of.size(); ++k)
      if (std::isfinite(of.objective[k]) && graph_.IsFree(checkers, layer, k)) free.push_back(k);
  });
  std::vector<char> leaves(free.size(), 0);
  graph_.InParallel(free.size(), [&](PassCheckers& checkers, size_t i) {
    leaves[i] = CanLeave(checkers.At(layer), carrier, of.joints.At(free[i]), options_);
  });
  Checker least(graph_.checks().WorldAt(layer), kClearanceShares.back());
  if (std::ranges::count(leaves, 1) == 0)
    for (size_t i = 0; i < free.size(); ++i) {
      CheckStop(graph_.checks().stop);
      leaves[i] = CanLeave(least, carrier, of.joints.At(free[i]), options_);
    }
  for (size_t i = 0; i < free.size(); ++i)
    if (!leaves[i]) graph_.TakeOut(layer, free[i]);
  if (std::ranges::count(leaves, 1) == 0) {
    ++lost_;
    const Joints q = of.joints.At(node);
    const JointLimits limits = LimitsAround(carrier.arm, options_.limit_margin, q);
    detail_[layer] =
        "no pose here can be entered or left: " + FindRetract(least, carrier, q, limits, options_).problem;
  }
  graph_.Count(least.counts());
}

}  // namespace millpose
