// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/closed_rounds.hpp"
#include "planning/ladder/worst_then_sum.hpp"
#include "planning/pass/collision_pruner.hpp"
#include "planning/pass/end_guard.hpp"
#include "planning/pass/pass_context.hpp"

namespace millpose {

/// The ladder search of a pass, repeated until what it finds is free of interference.
class SegmentSearch {
 public:
  SegmentSearch(const PassContext& context, CandidateGraph& graph, const BendLaw& law, bool all_revolutions);

  /// Of a closed pass a closed sequence, if one is free. Exact: none of the nodes left is better (of a closed
  /// one's sum: by more than 5e-4).
  Sequence Run();

  /// Afterwards: what was searched, and the cost of the ring before anything was found in its way; +inf where
  /// there was none.
  const LadderProblem& problem() const { return problem_; }
  double unbarred() const { return unbarred_; }
  /// Whether an open sequence is the best of all: where nothing was pruned, walls bar nothing.
  bool IsBest(const Sequence& sequence) const;
  /// What is in the way at a layer that was pruned because it could not be left; empty for others.
  std::string DetailAt(size_t layer) const { return guard_ ? guard_->Detail(layer) : std::string(); }

 private:
  using Search = std::function<std::optional<Sequence>()>;

  std::optional<Sequence> Straight(const Search& search);
  bool Check(const Sequence& sequence);
  bool IsFree(const Sequence& sequence);
  bool CanBeLeft(const Sequence& sequence);
  std::optional<Sequence> LeastWorstRing();
  std::optional<Sequence> LeastRing(const LadderProblem& problem, std::optional<Sequence> known);
  Sequence FreeOpen();

  const PassContext& context_;
  CandidateGraph& graph_;
  CollisionPruner pruner_;
  std::optional<EndGuard> guard_;
  LadderProblem problem_;
  SweepMemory join_memory_;
  WorstThenSum open_worst_;
  ClosedRounds rounds_;
  int round_ = 0;  ///< how many sequences were not free
  double unbarred_ = std::numeric_limits<double>::infinity();
};

}  // namespace millpose
