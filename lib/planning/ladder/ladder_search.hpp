// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <list>
#include <memory>
#include <set>
#include <stop_token>

#include "planning/ladder/layer.hpp"

namespace millpose {

/// Nodes of neighbouring layers between which the way is barred, although both are free: (from, to).
using BlockedEdges = std::set<std::pair<size_t, size_t>>;

struct SweepRows;
struct LadderProblem;

/// What sweeps over the layers of a pass have found, for the searches to come over the same layers.
class SweepMemory {
 public:
  SweepMemory();
  ~SweepMemory();
  /// Rows to sweep with from the nodes first..last−1 of layer 0: those of the last such sweep, else a copy of
  /// those of the widest.
  SweepRows& RowsFor(size_t first, size_t last);
  /// LeastToGo of the problem; kept and brought up to date where only `versions` say that it changed.
  const std::vector<std::vector<double>>& ToGoFor(const LadderProblem& problem);

 private:
  static constexpr size_t kMostKept = 4;
  struct Kept {
    size_t first, last;
    std::unique_ptr<SweepRows> rows;
  };
  std::list<Kept> kept_;  ///< the last used first
  std::unique_ptr<struct BackwardRows> backward_;
};

/// Layers of a pass and what a sequence through them may do.
struct LadderProblem {
  std::span<const Layer> layers;
  StepRule rule;
  std::span<const BlockedEdges> blocked;  ///< entry t: from layer t to layer (t+1) mod count; may be empty
  bool banded = false;  ///< look only at predecessors whose rotation a step can come from (see BandWidth)
  /// No step leaps over pruned nodes of the layer that it leaves: the motion would pass through them.
  bool walls = false;
  std::stop_token stop;
  std::span<const char> break_before;  ///< layers before which the tool is lifted in any case; may be empty
  /// Searches over the same layers with ever more pruned keep what they find here; null: each starts
  /// anew.
  SweepMemory* memory = nullptr;
  /// With `memory`: entry t differs from what it was whenever nodes of layer t or edges from it were pruned
  /// since.
  std::span<const uint64_t> versions = {};
  double most = std::numeric_limits<double>::infinity();  ///< no node of a larger objective; no wall either
  /// The cost of a sequence is its largest objective instead of the sum, and motion costs nothing; of open
  /// ones alone.
  bool worst = false;
  size_t first_layer = 0;                 ///< of a closed pass: where sweeps begin and end
  std::span<const Joints> max_step = {};  ///< entry t: of the step from layer t on; empty: the rule's own

  /// The rule of the step from layer `t` to the next, from the last to the first.
  StepRule RuleFrom(size_t t) const {
    StepRule of = rule;
    if (!max_step.empty()) of.max_step = max_step[t];
    return of;
  }
};

inline constexpr size_t kNoNode = std::numeric_limits<size_t>::max();

/// A sequence of nodes, one per layer (kNoNode for an empty layer).
struct Sequence {
  std::vector<size_t> nodes;
  std::vector<bool> break_before;  ///< the tool is lifted before layer t
  double cost = 0;                 ///< Σ objective + motion, without the breaks
  bool closed = false;             ///< the step from the last layer to the first is within the rule
  /// Where a part runs on over the beginning of the next (LiftedSearch): the nodes of that end, from the
  /// layer before the lift on. What they cost above the least is in `cost`.
  std::vector<Sequence> tails = {};
};

/// How often the tool is lifted; a point without a node counts for more than all lifts.
size_t Breaks(const Sequence& sequence);

/// The sequence with the fewest breaks, and among those of least cost: Σ objective + motion_weight·Σ|Δq|²,
/// every joint step within the rule modulo full revolutions, the branch kept. Dynamic program (Bellman 1957)
/// with implicit edges, two rolling cost rows and one predecessor per node.
Sequence SearchOpen(const LadderProblem& problem);

/// The same for a closed pass: the sequence of least cost that has no break and whose step from the last
/// layer to the first is one as any other. Empty when there is none that costs less than `below`. Exact: a
/// sweep there and a sweep back bound what goes through each node; of the layer that has the fewest nodes
/// left below a limit each is tried by a sweep that leaves out what costs too much, the limit being raised
/// until there is a sequence. `max_sweeps` ends it early, with the best so far; up to 16 sweeps ask for any
/// good sequence, whatever it costs.
std::optional<Sequence> SearchClosed(const LadderProblem& problem,
                                     int max_sweeps = std::numeric_limits<int>::max(),
                                     double below = std::numeric_limits<double>::infinity());

/// More than any sequence can cost, so that one break less always wins.
double BreakPenalty(const LadderProblem& problem);

/// How far apart (rad) the rotations about the tool axis of two neighbouring nodes can lie: joints turning by
/// Δq turn the tool by no more than Σ|Δq|, and the tools' frames at rotation 0 lie `nominal_angle` apart, so
/// by the triangle inequality of angles |Δrotation| ≤ Σ max_step + nominal_angle.
double BandWidth(const StepRule& rule, double nominal_angle);

}  // namespace millpose
