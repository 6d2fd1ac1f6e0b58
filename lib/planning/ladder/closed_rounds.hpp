// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/sweep.hpp"

namespace millpose {

/// Closed sequences of a ring in searches over the same layers with ever more pruned, where any good one will
/// do: the best through the first node of the last one, by one sweep that leaves out what costs far more.
class ClosedRounds {
 public:
  /// A closed sequence; the first, and where none goes through that node or all have become a tenth dearer,
  /// is what SearchClosed finds in `max_sweeps`.
  std::optional<Sequence> Search(const LadderProblem& problem, int max_sweeps);
  /// From now on through the first node of `sequence`.
  void GoOnFrom(const LadderProblem& problem, const Sequence& sequence);

 private:
  bool MuchChanged(const LadderProblem& problem);
  double LeastThrough(const LadderProblem& problem);
  std::optional<Sequence> Through(const LadderProblem& problem);
  std::optional<Sequence> ThroughRaised(const LadderProblem& problem, double least, int raise);

  size_t first_ = 0, last_ = 0;  ///< nodes of the first layer that differ by full revolutions; none at first
  double limit_ = std::numeric_limits<double>::infinity();  ///< what a sequence may cost
  double chosen_at_ = 0;                                    ///< what a sequence cost when the node was chosen
  SweepMemory own_;                                         ///< where the problem has none
  const ToGo* to_go_ = nullptr;
  SweepRows rows_;
  std::vector<uint64_t> versions_;
};

}  // namespace millpose
