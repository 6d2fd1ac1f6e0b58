// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep of the ladder search's dynamic program from the end back, which bounds closed sequences.
#pragma once

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// What the rest of a closed sequence costs at the least from each node of each layer on, the node itself not
/// counted: walls and edges that were pruned are left aside, and it may close into any node of the first
/// layer.
using ToGo = std::vector<std::vector<double>>;

/// A sweep back, which keeps what it finds for the next over the same layers with ever more pruned.
struct BackwardRows {
  struct OfLayer {
    std::vector<BestPredecessor> relaxed;  ///< per node: the cheapest step on
    std::vector<double> beyond;            ///< per node: what the rest costs, the node counted
    uint64_t version = 0;
  };
  std::vector<OfLayer> layers;
  ToGo to_go;
  size_t first_layer = 0;
  double most = 0;
};

/// Per layer and node, 0 for nodes that do not count; empty where all do.
using NodeMask = std::vector<std::vector<char>>;

/// Through nodes that count alone.
const ToGo& LeastToGo(const LadderProblem& problem, const NodeMask& counted, BackwardRows& rows);

}  // namespace millpose
