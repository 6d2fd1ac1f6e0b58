// SPDX-License-Identifier: GPL-3.0-or-later
// The bottleneck of a closed pass: how small the largest objective along a closed sequence can be.
#pragma once

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// Whether there is a closed sequence through nodes of no larger objective than `problem.most`. Exact: masks
/// of the nodes that each sequence began at are carried round, 64 nodes at a time (AnyReturning).
bool CanClose(const LadderProblem& problem);

/// The least value of `problem.most` with which CanClose() holds, one of the nodes' objectives; +inf where
/// there is no closed sequence at all. `none_below`: no closed sequence has a smaller largest objective, as
/// the caller knows; the search goes up from there. Bisection over the values of the nodes: both its ends are
/// proven.
double LeastClosedBound(const LadderProblem& problem, double none_below = 0);

}  // namespace millpose
