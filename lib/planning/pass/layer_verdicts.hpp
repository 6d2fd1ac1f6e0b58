// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/candidate_graph.hpp"
#include "planning/result/verdict_map.hpp"

namespace millpose {

/// What is known of the nodes of layer t, on the rotations of the axis map: of each cell the node nearest to
/// its middle of which something is known. Pairs are those of the World.
AxisVerdicts LayerVerdicts(const CandidateGraph& graph, size_t t);

}  // namespace millpose
