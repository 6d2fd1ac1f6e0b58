// SPDX-License-Identifier: GPL-3.0-or-later
// One sweep of the ladder search's dynamic program, which keeps what it finds for the next.
#pragma once

#include "planning/ladder/backward_sweep.hpp"
#include "planning/ladder/layer_steps.hpp"

namespace millpose {

/// What a sweep has found, layer by layer.
struct SweepRows {
  struct OfLayer {
    CostRow row;                           ///< of the cheapest way to each node
    std::vector<BestPredecessor> relaxed;  ///< per node, without breaks
    std::vector<uint32_t> previous;        ///< on the cheapest way
    uint64_t version = 0;                  ///< of the layer before, when relaxed
    double most = 0;                       ///< nodes of larger objectives were left out
    double limit = 0;                      ///< and those through which every sequence costs more
    bool after_break = false;              ///< no step into this layer was asked for
  };
  std::vector<OfLayer> layers;
};

/// One sweep, from LadderProblem::first_layer on round; layers count from there. It gives the same costs and
/// nodes, bit by bit, whatever the rows that it starts from have kept from an earlier sweep over the same
/// layers with less pruned or other first nodes.
class Sweep {
 public:
  Sweep(const LadderProblem& problem, double break_penalty)
      : problem_(problem), layers_(problem.layers), break_penalty_(break_penalty) {}

  /// From now on nodes are left out through which every closed sequence costs more than `at_most`. `to_go`
  /// outlives the sweep.
  void LeaveOutAbove(double at_most, const ToGo& to_go);

  /// Starts with the nodes first..last−1 of layer 0. False when the last layer cannot be reached; with
  /// `breaks` it always can. `rows` outlive what is asked of this sweep.
  bool Forward(SweepRows& rows, size_t first, size_t last, bool breaks);
  /// The same where one may also enter anew before layer t, at the cost enter[t] (LeastBefore of another
  /// sweep); not where the tool is lifted in any case.
  bool Forward(SweepRows& rows, size_t first, size_t last, bool breaks, std::vector<double> enter);
  /// Cost of the cheapest way through the layers before t; +inf where there is none, or none before.
  double LeastBefore(size_t t) const { return least_cost_before_[t]; }

  /// Cheapest way to close into one of the nodes first..last−1 of layer 0; its cost is that of the whole
  /// cycle.
  struct Closing {
    BestPredecessor by;
    size_t into = kNoNode;
  };
  Closing Close(size_t first, size_t last) const;

  size_t least_node() const { return least_node_; }
  double least() const { return least_; }  ///< cost of the way to it

  /// The sequence that ends in `node` of the last layer that has nodes.
  Sequence Trace(size_t node) const;
  /// The closed one that Close() has found.
  Sequence TraceClosed(const Closing& closing) const;
  /// Adds the way to `node` of the last layer that has nodes, or to the cheapest node before layer `t`, to
  /// `sequence`. The layer before which it was entered anew; kNoNode where it goes back to the first layer.
  size_t TraceFrom(size_t node, Sequence& sequence) const { return TraceBack(last_used_, node, sequence); }
  size_t TraceBefore(size_t t, Sequence& sequence) const {
    return TraceBack(used_before_[t], least_before_[t], sequence);
  }

 private:
  /// What of the row of the layer before is not as it was.
  struct Changes {
    bool known = false, some = false, some_less = false;
    std::vector<char> changed;
  };

  /// The place of layer t from the first on.
  size_t At(size_t t) const {
    const size_t at = t + problem_.first_layer;
    return at < layers_.size() ? at : at - layers_.size();
  }
  void Start(size_t first, size_t last);
  double Value(double objective) const;
  bool IsAbove(double cost, size_t t, size_t node) const;
  double MostBefore(size_t t, size_t node) const;
  double Combined(double cost, double objective) const;
  void Advance(size_t t, bool breaks, bool must_break);
  void RelaxAll(size_t t, bool must_break);
  void Take(size_t t);
  LayerSteps StepsFrom(size_t from, size_t to) const;
  size_t TraceBack(size_t t, size_t node, Sequence& sequence) const;

  const LadderProblem& problem_;
  std::span<const Layer> layers_;
  double break_penalty_;
  const ToGo* to_go_ = nullptr;
  double limit_ = std::numeric_limits<double>::infinity();
  SweepRows* rows_ = nullptr;
  Changes changes_;
  std::vector<size_t> used_before_, least_before_;
  std::vector<double> least_cost_before_, enter_;
  std::vector<double> row_;   ///< costs of the layer that is being looked at
  std::vector<char> wanted_;  ///< of its nodes, those whose predecessor is looked for
  size_t last_used_ = kNoNode, least_node_ = 0;
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace millpose
