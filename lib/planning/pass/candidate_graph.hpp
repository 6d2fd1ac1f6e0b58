// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "planning/ladder/ladder_search.hpp"
#include "planning/pass/point_verdicts.hpp"

namespace millpose {

/// The ladder graph of a pass: the candidates of its points as layers, what is known of these nodes and of
/// the transitions between them, what was pruned, and how large steps may be. Whether nodes and transitions
/// interfere is asked for lazily; what PointVerdicts know is not looked at again. Prunings are of this graph
/// alone, verdicts outlive it.
class CandidateGraph {
 public:
  enum class Verdict : uint8_t { kUnknown, kFree, kBlocked };

  /// `max_step`: rad, entry t of the step from layer t on. `known`: one per layer, of no other.
  CandidateGraph(PassChecks checks, std::vector<Layer> layers, std::vector<Joints> max_step,
                 std::vector<std::shared_ptr<PointVerdicts>> known);

  size_t size() const { return layers_.size(); }
  std::span<const Layer> layers() const { return layers_; }
  const Layer& layer(size_t t) const { return layers_[t]; }
  size_t Next(size_t t) const { return t + 1 == layers_.size() ? 0 : t + 1; }
  const PassChecks& checks() const { return checks_; }

  // Nodes.
  Verdict VerdictOf(size_t layer, size_t node) const { return verdict_[layer][node]; }
  /// Of a blocked node: the pair of bodies, as in Sighting; −1 where none interferes by itself.
  int PairOf(size_t layer, size_t node) const { return pair_[layer][node]; }
  /// Looks at a node of which nothing is known; true when it was pruned now.
  bool Prunes(PassCheckers& checkers, size_t layer, size_t node);
  /// Whether a node is free; pruned when not.
  bool IsFree(PassCheckers& checkers, size_t layer, size_t node);
  /// What a pose at a layer's point meets, be it a node or not.
  std::optional<ContactCandidate> Meets(PassCheckers& checkers, size_t layer, const FreedomValues& freedoms,
                                        const Joints& q);
  /// Prunes a node that interferes with nothing by itself.
  void TakeOut(size_t layer, size_t node);
  /// Gives back the nodes that TakeOut took in the layers that `sequence` goes through.
  void GiveBack(const Sequence& sequence);

  /// Between nodes of neighbouring layers.
  struct Transition {
    size_t from, to;
    Joints q, step;  ///< rad, where it begins and the short way round from there
  };
  /// That of a sequence from layer t to the next; empty where the tool is lifted or nothing is cut.
  std::optional<Transition> TransitionOf(const Sequence& sequence, size_t t) const;
  /// From a node of layer t to one of the next; empty where that is a larger step than may be, or barred.
  std::optional<Transition> TransitionBetween(size_t t, size_t from, size_t to) const;
  /// Whether the straight motion from a free node of layer t to a free node of the next is free; barred when
  /// not.
  bool IsFree(PassCheckers& checkers, size_t t, const Transition& transition);
  void Bar(size_t t, const Transition& transition);
  /// Of what Bar alone has barred.
  void Unbar(size_t t, const Transition& transition);
  void BoundStep(size_t t, const Joints& max_step);

  // For searches (LadderProblem).
  std::span<const Joints> max_step() const { return max_step_; }
  std::span<const BlockedEdges> barred() const { return barred_; }
  /// Per layer: rises with what changes of its nodes and of the steps from it.
  std::span<const uint64_t> versions() const { return versions_; }
  SweepMemory& sweeps() { return sweeps_; }

  /// Runs `work(checkers, i)` for i in 0..count−1 in parallel.
  void InParallel(size_t count, const std::function<void(PassCheckers&, size_t)>& work);
  /// Adds what was looked at by other checkers.
  void Count(const CheckCounts& counts) { counts_ += counts; }
  const CheckCounts& counts() const { return counts_; }
  long long nodes() const;
  /// Nodes whose interference was asked for, or that were taken out.
  long long nodes_checked() const;
  int nodes_pruned() const;

  /// The last interference found at a layer or on the way from it; empty when there was none.
  std::string Detail(size_t layer) const;
  std::optional<ContactCandidate> LastContactCandidate(size_t layer) const {
    return last_problem_[layer] ? last_problem_[layer]->sighting : std::nullopt;
  }
  /// What was met last at a layer was as well at another.
  void CopyProblem(size_t from, size_t to) { last_problem_[to] = last_problem_[from]; }

 private:
  /// A node that TakeOut took, and what was known of it.
  struct Taken {
    size_t layer, node;
    double objective;
    Verdict verdict;
  };

  PassChecks checks_;
  std::vector<Layer> layers_;
  std::vector<Joints> max_step_;
  std::vector<std::shared_ptr<PointVerdicts>> known_;
  std::vector<std::vector<Verdict>> verdict_;
  std::vector<std::vector<int>> pair_;
  std::vector<Taken> taken_;
  std::vector<BlockedEdges> barred_;
  std::vector<uint64_t> versions_;
  std::vector<std::optional<CutProblem>> last_problem_;  // per layer
  SweepMemory sweeps_;
  CheckCounts counts_;
};

}  // namespace millpose
