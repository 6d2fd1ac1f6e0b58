// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/end_guard.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

/// Layers of a pass that are given up for this. Then its piece is left to the gaps, which leave it out.
constexpr int kMostLost = 8;

}  // namespace

EndGuard::EndGuard(const World& world, const Carrier& carrier, const RetractOptions& options,
                   std::span<const Layer> layers, std::span<const char> break_before, CollisionPruner& pruner,
                   int threads, std::stop_token stop)
    : world_(world),
      carrier_(carrier),
      options_(options),
      layers_(layers),
      break_before_(break_before),
      pruner_(pruner),
      threads_(threads),
      stop_(std::move(stop)),
      settled_(layers.size(), 0),
      detail_(layers.size()) {}

bool EndGuard::Check(const Sequence& sequence) {
  const std::vector<size_t> ends = EndsOf(sequence);
  std::vector<char> stuck(ends.size(), 0);
  counts_ += CheckInParallel(world_, ends.size(), threads_, stop_, [&](Checker& checker, size_t i) {
    const Joints q = layers_[ends[i]].joints.At(sequence.nodes[ends[i]]);
    stuck[i] = !CanLeave(checker, carrier_, q, options_);
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
  const size_t count = layers_.size();
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
  const Layer& of = layers_[layer];
  std::vector<size_t> free;
  Checker checker(world_), least(world_, kClearanceShares.back());
  for (size_t k = 0; k < of.size(); ++k)
    if (std::isfinite(of.objective[k]) && pruner_.IsFree(checker, layer, k)) free.push_back(k);
  std::vector<char> leaves(free.size(), 0);
  counts_ += CheckInParallel(world_, free.size(), threads_, stop_, [&](Checker& full, size_t i) {
    leaves[i] = CanLeave(full, carrier_, of.joints.At(free[i]), options_);
  });
  if (std::ranges::count(leaves, 1) == 0)
    for (size_t i = 0; i < free.size(); ++i) {
      CheckStop(stop_);
      leaves[i] = CanLeave(least, carrier_, of.joints.At(free[i]), options_);
    }
  for (size_t i = 0; i < free.size(); ++i)
    if (!leaves[i]) pruner_.TakeOut(layer, free[i]);
  if (std::ranges::count(leaves, 1) == 0) {
    ++lost_;
    const Joints q = of.joints.At(node);
    const auto [lower, upper] = LimitsAround(carrier_.arm, options_.limit_margin, q);
    detail_[layer] = "no pose here can be entered or left: " +
                     FindRetract(least, carrier_, q, lower, upper, options_).problem;
  }
  counts_ += checker.counts();
  counts_ += least.counts();
}

}  // namespace millpose
