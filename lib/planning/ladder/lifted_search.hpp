// SPDX-License-Identifier: GPL-3.0-or-later
// Sequences along which the tool may be lifted and come back in another pose, and rings that are opened.
#pragma once

#include <array>

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

inline constexpr size_t kMostLifts = 3;

/// What a lift must be worth.
struct LiftPrice {
  size_t most = 0;  ///< lifts, up to kMostLifts
  /// Share of the pass's objective, 0..1, that each lift must gain: of the sum with motion, and with
  /// worst_first of the worst value, or of the sum where the worst does not rise.
  double gain = 0;
  bool worst_first = false;  ///< as WorstThenSum
};

/// What a sequence is judged by.
struct SequenceValue {
  double worst = 0, cost = 0;
};

/// Which of the best sequences with at most 0, 1, … lifts is worth its lifts: the one of least value, each
/// lift counted with its price; of equals the one with the fewest. `values` fall, or stay.
size_t WorthLifting(std::span<const SequenceValue> values, const LiftPrice& price);

/// Looks for sequences with lifts: a lift joins any two nodes of neighbouring layers. Dynamic program with
/// a row of costs for each number of lifts (Sweep::Forward's `enter`), so exact on the nodes. Keeps what it
/// finds from search to search over the same layers with ever more pruned.
class LiftedSearch {
 public:
  /// `over`: so many points of its beginning the next part is run over by the end of the one before.
  explicit LiftedSearch(const LiftPrice& price, size_t over = 0) : price_(price), over_(over) {}

  /// The best open sequence that is worth its lifts. Layers with problem.break_before are lifted at in any
  /// case. `may`: entry t: before layer t; empty: everywhere.
  Sequence Open(const LadderProblem& problem, std::span<const char> may = {});

  /// Round a closed pass, opened at the best place: lifts as above and one more, which is free. That may be
  /// before layer 0, else the sequence is closed there (Sequence::closed); with `over` only where no other
  /// place does. By branch and bound over the first layer's nodes, ended early after `max_sweeps` for each
  /// number of lifts. Where so few are not enough, as few as are, up to kMostLifts + 1. Empty where these are
  /// not, or a layer has no nodes.
  std::optional<Sequence> Round(const LadderProblem& problem,
                                int max_sweeps = std::numeric_limits<int>::max());

 private:
  using Memories = std::array<SweepMemory, kMostLifts + 2>;  ///< one per row
  std::vector<Sequence> OpenRows(const LadderProblem& problem, size_t most, std::span<const char> may,
                                 Memories& memories);
  std::optional<Sequence> RoundWith(const LadderProblem& problem, size_t lifts, int max_sweeps);
  std::optional<Sequence> BestRoundWith(const LadderProblem& problem, size_t lifts, int max_sweeps);

  LiftPrice price_;
  size_t over_;
  Memories open_, for_worst_, round_;
};

/// Layers before which `sequence` is lifted, in ascending order.
std::vector<size_t> LiftsOf(const Sequence& sequence);

}  // namespace millpose
