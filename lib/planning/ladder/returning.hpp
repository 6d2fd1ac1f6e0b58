// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes a closed sequence can come back to, whatever it costs.
#pragma once

#include "planning/ladder/sweep.hpp"

namespace millpose {

/// For every range of nodes of LadderProblem::first_layer, which differ by full revolutions only, whether a
/// closed sequence through nodes that count begins in it and ends in it. A sweep that carries
/// no costs, only from which of 64 ranges each node is reached: many ranges are told for the price of about
/// one sweep.
std::vector<char> AreReturning(const LadderProblem& problem, const std::vector<NodeRange>& ranges,
                               const NodeMask& counted);

}  // namespace millpose
