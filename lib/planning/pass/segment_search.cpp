// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/segment_search.hpp"

#include "base/units.hpp"
#include "planning/ladder/least_worst_ring.hpp"

namespace millpose {
namespace {

// Sweeps that ask for any good closed sequence.
constexpr int kQuickSweeps = 3;
constexpr int kAllSweeps = std::numeric_limits<int>::max();
// Share of its cost by which a free ring is hardly cheaper than another.
constexpr double kHardlyCheaper = 5e-4;

}  // namespace

SegmentSearch::SegmentSearch(const PassContext& context, CandidateGraph& graph, const BendLaw& law,
                             bool all_revolutions)
    : context_(context),
      graph_(graph),
      pruner_(graph, law),
      problem_(MakeProblem(context, graph, all_revolutions)) {
  problem_.memory = &graph.sweeps();
  if (context.options.leave) guard_.emplace(graph, *context.options.leave, context.break_before);
}

Sequence SegmentSearch::Run() {
  if (context_.closed) {
    std::optional<Sequence> least;
    if (!context_.options.worst_first)
      least = LeastRing(problem_, std::nullopt);
    else if (std::optional<Sequence> free = LeastWorstRing())
      least = LeastRing(Within(problem_, WorstOf(graph_.layers(), *free)), free);
    if (least) return std::move(*least);
  }
  return FreeOpen();
}

/// What `search` finds when motions that bend too far are barred (CollisionPruner::Straight).
std::optional<Sequence> SegmentSearch::Straight(const Search& search) {
  return pruner_.Straight(search, [&](const Sequence& as) {
    LadderProblem joined = problem_;
    joined.memory = &join_memory_;
    if (as.closed) return SearchClosed(joined, kQuickSweeps).has_value();
    return Breaks(SearchOpen(joined)) <= Breaks(as);
  });
}

/// Whether a sequence is free; nodes and motions that interfere are pruned.
bool SegmentSearch::Check(const Sequence& sequence) {
  if (sequence.closed && !std::isfinite(unbarred_)) unbarred_ = sequence.cost;
  return pruner_.Check(sequence);
}

/// The same; else less is left to choose from, the more sequences were not free.
bool SegmentSearch::IsFree(const Sequence& sequence) {
  if (Check(sequence)) return true;
  pruner_.PruneInRound(sequence, round_++);
  return false;
}

/// Whether its ends can be left; else what cannot is pruned there.
bool SegmentSearch::CanBeLeft(const Sequence& sequence) { return !guard_ || guard_->Check(sequence); }

/// A free ring of least worst value.
std::optional<Sequence> SegmentSearch::LeastWorstRing() {
  const auto is_free = [&](const Sequence& sequence, int round) {
    if (Check(sequence)) return CanBeLeft(sequence);
    pruner_.BarBeside(sequence);
    pruner_.PruneInRound(sequence, round);
    return false;
  };
  return SearchLeastWorstRing(problem_, {[&](const Search& search) { return Straight(search); }, is_free});
}

/// A free ring of least sum. While there is interference to find, any good one finds it; a free one is kept
/// where the best of all is hardly cheaper. `known`: one that is free.
std::optional<Sequence> SegmentSearch::LeastRing(const LadderProblem& problem,
                                                 std::optional<Sequence> known) {
  std::optional<Sequence> free = known;
  for (;;) {
    if (!free) {
      free = Straight([&] { return rounds_.Search(problem, kQuickSweeps); });
      if (!free) free = Straight([&] { return SearchClosed(problem); });
      if (!free) return known;
      if (!IsFree(*free)) {
        free.reset();
        continue;
      }
    }
    const double below = (1 - kHardlyCheaper) * free->cost;
    std::optional<Sequence> best = Straight([&] { return SearchClosed(problem, kAllSweeps, below); });
    if (best && best->cost < below) {
      free = std::move(best);
      rounds_.GoOnFrom(problem, *free);
      if (!IsFree(*free)) {
        free.reset();
        continue;
      }
    }
    if (CanBeLeft(*free)) return free;
    free.reset();
  }
}

/// An open sequence, with the fewest breaks.
Sequence SegmentSearch::FreeOpen() {
  for (;;) {
    std::optional<Sequence> sequence = Straight([&] {
      return std::optional(context_.options.worst_first ? open_worst_.Open(problem_) : SearchOpen(problem_));
    });
    if (IsFree(*sequence) && CanBeLeft(*sequence)) return std::move(*sequence);
  }
}

bool SegmentSearch::IsBest(const Sequence& sequence) const {
  if (sequence.closed || graph_.nodes_pruned() > 0) return false;
  for (size_t t = 1; t < graph_.size(); ++t)
    if (sequence.break_before[t] && (context_.break_before.empty() || !context_.break_before[t]))
      return false;
  if (std::ranges::count(sequence.nodes, kNoNode) > 0) return false;
  return !context_.options.worst_first || WorstOf(graph_.layers(), sequence) <= open_worst_.bound();
}

}  // namespace millpose
