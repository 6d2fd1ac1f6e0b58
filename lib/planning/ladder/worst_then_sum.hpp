// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// How far above the smallest worst value the nodes of a sequence may lie, as a share of it: rounding, so
/// that a plan is never worse than any other sequence of the same nodes.
inline constexpr double kWorstTolerance = 1e-6;

/// Searches by the worst value first: the smallest bound under which a sequence with the fewest breaks
/// exists, then the least sum of objective and motion among the sequences within kWorstTolerance of that
/// bound.
///
/// Open passes: one sweep with the largest value in place of the sum. It keeps the bound from search to
/// search over the same layers with ever more pruned: it can only rise, and is looked for again where nothing
/// is left below it. Closed ones: LeastClosedBound.
class WorstThenSum {
 public:
  Sequence Open(const LadderProblem& problem);
  std::optional<Sequence> Closed(const LadderProblem& problem);
  /// The bound of the last search; +inf before the first.
  double bound() const { return bound_; }

 private:
  double bound_ = std::numeric_limits<double>::infinity();
  size_t breaks_ = 0;   ///< and points without a node
  SweepMemory memory_;  ///< of sweeps for the largest value: the problem's own are for sums
};

/// The problem with no node whose objective is above `bound` by more than kWorstTolerance.
LadderProblem Within(LadderProblem problem, double bound);

/// A search that may end early, with the best sequence so far, after a number of sweeps.
using BoundedSearch = std::function<std::optional<Sequence>(const LadderProblem&, int max_sweeps)>;

/// Of what `search` finds the sequence of least worst value, by bisection over the values of the nodes. Empty
/// when there is none at all.
std::optional<Sequence> LeastWorst(const LadderProblem& problem, const BoundedSearch& search);

/// Largest objective along a sequence.
double WorstOf(std::span<const Layer> layers, const Sequence& sequence);

}  // namespace millpose
