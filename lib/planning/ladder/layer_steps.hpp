// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/band.hpp"
#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// How far apart (rad) the first freedoms of nodes of two neighbouring layers may lie; +inf where the problem
/// is not banded.
double BandBetween(const LadderProblem& problem, const StepRule& rule, const Layer& from, const Layer& to);

/// The cheapest steps from one layer into the nodes of the layer beside it.
class LayerSteps {
 public:
  /// What steps between the two may be.
  struct Law {
    StepRule rule;
    double band = 0;  ///< as the following for BandOfLayer
    bool walls = false;
    const BlockedEdges* blocked = nullptr;  ///< from `source` to `target`
  };
  LayerSteps(const Layer& source, const Layer& target, const Law& law);

  /// The best predecessors of the nodes that `wanted` says so of, where the ways to the nodes of the source
  /// cost `row`; of equals the first. Only such as cost less than `best` holds for the node; {} where there
  /// are none. What it holds for the others is left alone.
  void Relax(const CostRow& row, const std::vector<char>& wanted, std::vector<BestPredecessor>& best);

 private:
  void RelaxBlockOf(const CostRow& row, int lane, size_t begin, unsigned nodes,
                    std::vector<BestPredecessor>& best);
  void RelaxOne(const CostRow& row, int lane, size_t node, BestPredecessor& by);
  void Found(const CostRow& row, int lane, size_t node, double below, BestPredecessor& by);
  void RelaxUnbarred(const CostRow& row, int lane, size_t node, BestPredecessor& by);

  const Layer& source_;
  const Layer& target_;
  Law law_;
  BandOfLayer band_;
  size_t guess_ = 0;  ///< a predecessor that may be as good as any
};

}  // namespace millpose
