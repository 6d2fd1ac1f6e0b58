// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/ladder_search.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A lower bound on what any free sequence of the same nodes costs that is lifted where `sequence` is: the
/// problem is searched once more with only those nodes and motions pruned that are known to interfere, so
/// without walls, and with all that was never looked at as free. `layers` are the problem's, their objectives
/// as then known. Closed sequences: the first and the last node need not be the same, so the bound is a
/// little lower than the least closed one. With `worst_first` also of the largest objective; the sum is then
/// bounded among the sequences whose largest objective is no larger than that of `sequence`. The problem's
/// memory, if it has one, is of searches for the sum over the same layers with less pruned.
LadderBound BoundLadder(LadderProblem problem, const Sequence& sequence, bool worst_first);

/// The same where `sequence` is known to be the best of all: its own values.
LadderBound BoundOfBest(std::span<const Layer> layers, const Sequence& sequence, bool worst_first);

}  // namespace millpose
