// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/bend_law.hpp"
#include "planning/pass/candidate_graph.hpp"

namespace millpose {

/// Decides what of a ladder graph is looked at and pruned, until what a search finds is free and bends no
/// further than it may.
class CollisionPruner {
 public:
  /// `law`: how far motions may bend half-way. Where the points lie too far apart for its bound, a fifth more
  /// than with the freedoms unchanged.
  CollisionPruner(CandidateGraph& graph, const BendLaw& law)
      : graph_(graph), law_(law), excused_(graph.size(), 0), barred_alone_(graph.size(), 0) {}

  /// Whether there still is a sequence that is closed as the given one, or has no more breaks.
  using Joins = std::function<bool(const Sequence&)>;

  /// What `search` finds once no motion of it bends too far. Where the freedoms cannot stay as they are, a
  /// fifth more than with the nearest pose of the next layer is allowed as long as `joins` finds nothing that
  /// bends less; without `joins` always.
  std::optional<Sequence> Straight(const std::function<std::optional<Sequence>()>& search,
                                   const Joins& joins = {});

  /// Checks the nodes of `sequence` and the motions between them. What interferes is pruned: a node with
  /// its neighbours on the grid up to the next free ones, and what lies beside these in the layers before and
  /// after, each time twice as many layers away. True when all is free.
  bool Check(const Sequence& sequence);

  /// What bars the motions that the last check of `sequence` found bars those beside them as well: the same a
  /// node further, and from the layers before and after. They are looked at now; met one at a time they would
  /// take as many searches.
  void BarBeside(const Sequence& sequence);

  /// For motions that go on interfering, by the number of searches so far, from 0: the first few bar motions
  /// alone, then all steps there become shorter; where that cannot be, they take their nodes with them, then
  /// their points, so that each search has less to choose from.
  void PruneInRound(const Sequence& sequence, int round);

 private:
  using Transition = CandidateGraph::Transition;
  /// Nodes of a branch, first..last, that were pruned together.
  struct Interval {
    size_t layer, first, last;
  };
  /// A motion from a node of layer t to one of the next.
  struct Motion {
    size_t t, from, to;
    auto operator<=>(const Motion&) const = default;
  };
  /// A motion that bends further than the freedoms ask for.
  struct Bent {
    size_t t;
    Transition motion;
    double share;  ///< of its steps that may remain
    Joints least;  ///< rad: steps that stay allowed in any case
  };
  enum class Extent { kNodes, kLayers };

  std::optional<Interval> CheckNode(PassCheckers& checkers, size_t layer, size_t node);
  std::vector<Interval> CheckNodes(const std::vector<std::pair<size_t, size_t>>& nodes);
  std::vector<std::pair<size_t, size_t>> Beside(const std::vector<Interval>& blocked) const;
  bool CheckMotion(PassCheckers& checkers, size_t from, const Sequence& sequence);
  std::vector<Motion> BarredOf(const std::vector<Motion>& motions);
  std::vector<Motion> Beside(const std::vector<Motion>& motions) const;
  bool Straighten(const Sequence& sequence, const Joins& joins);
  void Bar(const Bent& bent);
  bool BarWhatMayGo(std::span<const Bent> bents, const Sequence& sequence, const Joins& joins);
  bool BarAlone(const Bent& bent, const Sequence& sequence, const Joins& joins);
  bool Tighten(size_t t, const Transition& motion, double share, const Joints& least);
  Joints UnchangedStep(size_t from, size_t node) const;
  Joints StepBeside(size_t from, size_t node) const;
  void PruneBarred(const Sequence& sequence, Extent extent);

  CandidateGraph& graph_;
  const BendLaw& law_;
  std::vector<char> excused_;      ///< layers from which nothing bends less
  std::vector<int> barred_alone_;  ///< per layer: motions
  std::vector<size_t> barred_;     ///< layers whose motions interfered in the last check
  size_t flood_ = 4;               ///< layers to follow interference to either side, at the next check
};

}  // namespace millpose
