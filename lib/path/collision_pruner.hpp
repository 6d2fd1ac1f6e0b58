// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "cell/point_memory.hpp"
#include "motion/line.hpp"
#include "path/bend_law.hpp"
#include "path/cut_check.hpp"
#include "path/ladder_search.hpp"

namespace millpose {

/// Runs `work(checker, i)` for i in 0..count−1 in parallel with a few checkers.
CheckCounts CheckInParallel(const World& world, size_t count, int threads, std::stop_token stop,
                            const std::function<void(Checker&, size_t)>& work);

/// One line: which two bodies, how near, where.
std::string Describe(const Interference& interference);

/// What bounds the motions along a pass.
struct StepLimits {
  std::vector<Joints> max_step;  ///< rad: entry t of the step from layer t on
  /// mm, of the tip half-way (HalfwayDeviation). Where the points lie too far apart for that, a fifth more
  /// than with the freedoms unchanged (BendLaw).
  double max_deviation = std::numeric_limits<double>::infinity();
};

/// Interference of the nodes and edges of a ladder problem, asked for lazily and remembered.
class CollisionPruner {
 public:
  /// `scorers`: one per layer. `rotates_first`: the first freedom is the rotation about the tool axis, as
  /// PointMemory needs it.
  CollisionPruner(const World& world, const Carrier& carrier, std::span<const PointScorer> scorers,
                  std::vector<Layer>& layers, double swept_resolution, bool rotates_first, StepLimits limits,
                  int threads, std::stop_token stop);

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

  /// For motions that go on interfering: prunes the nodes at both ends of those that the last check
  /// found, or all nodes of the layers that they leave.
  enum class Extent { kNodes, kLayers };
  void PruneBarred(const Sequence& sequence, Extent extent);
  /// The same by the number of searches so far, from 0: the first few bar motions alone, then all steps there
  /// become shorter; where that cannot be, they take their nodes with them, then their points, so that each
  /// search has less to choose from.
  void PruneInRound(const Sequence& sequence, int round);
  /// Prunes a node that interferes with nothing by itself.
  void TakeOut(size_t layer, size_t node);

  /// Gives back the nodes that PruneBarred and TakeOut alone took, in the layers that `sequence` goes
  /// through: they interfere with nothing by themselves.
  void Reopen(const Sequence& sequence);

  enum class Verdict : uint8_t { kUnknown, kFree, kBlocked };
  Verdict VerdictOf(size_t layer, size_t node) const { return verdict_[layer][node]; }
  /// Of a blocked node: the pair of bodies, as in Sighting; −1 where it does not interfere by itself.
  int PairOf(size_t layer, size_t node) const { return pair_[layer][node]; }

  /// Runs `work(checker, layer)` for all layers in parallel, for which the next two may be called.
  void EachLayer(const std::function<void(Checker&, size_t)>& work);
  /// Whether a node is free; pruned when not, but for nothing beside it.
  bool IsFree(Checker& checker, size_t layer, size_t node);
  /// What a pose at a layer's point meets; remembers nothing but what poses there share.
  std::optional<Sighting> Meets(Checker& checker, size_t layer, const FreedomValues& freedoms,
                                const Joints& q);

  std::span<const Joints> max_step() const { return limits_.max_step; }
  std::span<const BlockedEdges> blocked_edges() const { return blocked_; }
  /// Per layer: rises with what is pruned of its nodes and of the edges from it.
  std::span<const uint64_t> versions() const { return versions_; }
  const CheckCounts& counts() const { return counts_; }
  int nodes_pruned() const { return nodes_pruned_; }
  /// Nodes whose interference was asked for.
  long long nodes_checked() const;
  /// The last interference found at a layer; empty when there was none.
  std::string Detail(size_t layer) const;
  std::optional<Sighting> LastSighting(size_t layer) const {
    return last_problem_[layer] ? last_problem_[layer]->sighting : std::nullopt;
  }

 private:
  /// A node that TakeOut took, and what was known of it.
  struct Taken {
    size_t layer, node;
    double objective;
    Verdict verdict;
  };

  /// Nodes of a branch, first..last, that were pruned together.
  struct Interval {
    size_t layer, first, last;
  };

  bool Blocks(Checker& checker, size_t layer, size_t node);
  std::optional<Interval> CheckNode(Checker& checker, size_t layer, size_t node);
  std::vector<Interval> CheckNodes(const std::vector<std::pair<size_t, size_t>>& nodes);
  std::vector<std::pair<size_t, size_t>> Beside(const std::vector<Interval>& blocked) const;
  /// Between nodes of neighbouring layers.
  struct Motion {
    size_t from, to;
    Joints q, step;  ///< rad, where it begins and the short way round from there
  };
  std::optional<Motion> MotionFrom(size_t t, const Sequence& sequence) const;
  /// Bounds the steps of the motions of `sequence` that bend too far more tightly. True when none does.
  bool Straighten(const Sequence& sequence, const Joins& joins);
  /// A motion that bends further than the freedoms ask for.
  struct Bent {
    size_t t;
    Motion motion;
    double share;  ///< of its steps that may remain
    Joints least;  ///< rad: steps that stay allowed in any case
  };
  void Bar(const Bent& bent);
  bool BarWhatMayGo(std::span<const Bent> bents, const Sequence& sequence, const Joins& joins);
  bool BarAlone(const Bent& bent, const Sequence& sequence, const Joins& joins);
  bool Tighten(size_t t, const Motion& motion, double share, const Joints& least);
  Joints UnchangedStep(size_t from, size_t node) const;
  Joints StepBeside(size_t from, size_t node) const;
  bool CheckMotion(Checker& checker, size_t from, size_t to, const Sequence& sequence);

  const World& world_;
  const Carrier& carrier_;
  std::vector<Layer>& layers_;
  bool rotates_first_;
  double swept_resolution_;
  StepLimits limits_;
  BendLaw law_;
  std::vector<char> excused_;      ///< layers from which nothing bends less
  std::vector<int> barred_alone_;  ///< per layer: motions
  int threads_;
  std::stop_token stop_;
  std::vector<std::vector<Verdict>> verdict_;
  std::vector<std::vector<int>> pair_;
  std::vector<Taken> taken_;
  std::vector<PointMemory> memory_;  // per layer
  std::vector<BlockedEdges> blocked_, free_;
  std::vector<uint64_t> versions_;
  std::vector<std::optional<CutProblem>> last_problem_;  // per layer
  std::vector<size_t> barred_;                           // layers whose motions interfered in the last check
  size_t flood_ = 4;  // layers to follow interference to either side, at the next check
  CheckCounts counts_;
  int nodes_pruned_ = 0;
};

}  // namespace millpose
