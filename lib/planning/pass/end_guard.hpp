// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/links/retract.hpp"
#include "planning/pass/candidate_graph.hpp"

namespace millpose {

/// Poses at the ends of pieces must be left and come to: what has no free retract is pruned there.
class EndGuard {
 public:
  /// `break_before`: layers before which the tool is lifted in any case; may be empty.
  EndGuard(CandidateGraph& graph, const RetractOptions& options, std::span<const char> break_before)
      : graph_(graph),
        options_(options),
        break_before_(break_before),
        settled_(graph.size(), 0),
        asked_(graph.size()),
        detail_(graph.size()) {}

  /// Looks at the nodes where `sequence` begins and ends because nothing goes on there (not where it breaks
  /// for its steps alone). Where one cannot be left, nodes of its layer are pruned that cannot: with the
  /// cell's clearances, or where none can with the smallest share of kClearanceShares. They are asked from
  /// the best on until enough are found that can; the others when one of them is chosen next. A layer of
  /// which no node can is pruned as a whole, so that the piece ends at the next. True when nothing was
  /// blocked.
  bool Check(const Sequence& sequence);

  /// What is in the way at a layer that was pruned as a whole; empty for others.
  const std::string& Detail(size_t layer) const { return detail_[layer]; }

 private:
  /// How far the nodes of a layer have been asked.
  struct Asked {
    std::vector<size_t> order = {};
    double share = 1;                ///< of the clearances, that they are to keep
    size_t next = 0;                 ///< in `order`: not asked yet
    bool any = false;                ///< some node can be left
    std::vector<size_t> stuck = {};  ///< found since the last pruning
  };

  std::vector<size_t> EndsOf(const Sequence& sequence) const;
  double ShareAt(size_t layer) const;
  bool Leaves(Checker& checker, size_t layer, size_t node) const;
  /// Which of the nodes can be left with the smallest share of the clearances.
  std::vector<char> WithLeast(size_t layer, const std::vector<size_t>& nodes);
  std::vector<size_t> InOrder(size_t layer) const;
  void AskOn(size_t layer, Asked& asked);
  void PruneWhatStays(size_t layer, size_t node);

  CandidateGraph& graph_;
  RetractOptions options_;
  std::span<const char> break_before_;
  std::vector<char> settled_;  ///< per layer: what is left of it can be left
  std::vector<std::optional<Asked>> asked_;
  std::vector<std::string> detail_;
  int lost_ = 0;  ///< layers pruned as a whole
};

}  // namespace millpose
