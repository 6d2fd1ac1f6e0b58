// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes a closed sequence can come back to, whatever it costs.
#pragma once

#include "planning/ladder/sweep.hpp"

namespace millpose {

/// For every range of nodes of LadderProblem::first_layer, which differ by full revolutions only, whether a
/// closed sequence through nodes that count begins in it and ends in it. `counted`: empty where all count. A
/// sweep that carries no costs, only from which of 64 ranges each node is reached: many ranges are told for
/// the price of about one sweep.
std::vector<char> AreReturning(const LadderProblem& problem, const std::vector<NodeRange>& ranges,
                               const NodeMask& counted);

/// Ranges of nodes of a layer, each of nodes that differ by full revolutions only.
struct ReturningNodes {
  size_t layer = 0;
  std::vector<NodeRange> ranges;
};

/// Some nodes of a lane, which no sequence leaves, that closed sequences come back to within
/// LadderProblem::most: of the layer in which the lane has the fewest nodes. No ranges: there is no closed
/// sequence in the lane.
ReturningNodes FindReturning(LadderProblem problem, size_t lane);

size_t CountLanes(const LadderProblem& problem);

/// The smallest LadderProblem::most, no larger than the problem's own, with which there is a closed sequence;
/// +inf where there is none. By bisection over the values of the nodes: proven in 10 to 20 sweeps.
double LeastClosedBound(const LadderProblem& problem);

/// The values that the bound of a sequence can have, ascending: from the largest of the layers' least ones up
/// to `most`. None where some layer has no node.
std::vector<double> PossibleBounds(const LadderProblem& problem, double most);

}  // namespace millpose
