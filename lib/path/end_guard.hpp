// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "path/collision_pruner.hpp"
#include "path/retract.hpp"

namespace millpose {

/// Poses at the ends of pieces must be left and come to: what has no free retract is pruned there.
class EndGuard {
 public:
  /// `break_before`: layers before which the tool is lifted in any case; may be empty.
  EndGuard(const World& world, const Carrier& carrier, const RetractOptions& options,
           std::span<const Layer> layers, std::span<const char> break_before, CollisionPruner& pruner,
           int threads, std::stop_token stop);

  /// Looks at the nodes where `sequence` begins and ends because nothing goes on there (not where it breaks
  /// for its steps alone). Where one cannot be left, all nodes of its layer are pruned that cannot: with
  /// the cell's clearances, or where none can with the smallest share of kClearanceShares. A layer of which
  /// no node can is pruned as a whole, so that the piece ends at the next. True when nothing was blocked.
  bool Check(const Sequence& sequence);

  /// What is in the way at a layer that was pruned as a whole; empty for others.
  const std::string& Detail(size_t layer) const { return detail_[layer]; }
  const CheckCounts& counts() const { return counts_; }

 private:
  std::vector<size_t> EndsOf(const Sequence& sequence) const;
  void PruneWhatStays(size_t layer, size_t node);

  const World& world_;
  const Carrier& carrier_;
  RetractOptions options_;
  std::span<const Layer> layers_;
  std::span<const char> break_before_;
  CollisionPruner& pruner_;
  int threads_;
  std::stop_token stop_;
  std::vector<char> settled_;  ///< per layer: what is left of it can be left
  std::vector<std::string> detail_;
  CheckCounts counts_;
  int lost_ = 0;  ///< layers pruned as a whole
};

}  // namespace millpose
