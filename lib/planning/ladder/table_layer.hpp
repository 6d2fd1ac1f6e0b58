// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/layer.hpp"

namespace millpose {

/// All freedoms of a node.
FreedomValues FreedomsOf(const Layer& layer, size_t node);

/// MakeLayer of all of a table (SeedsOf) and of `others`, which have no course: without making and sorting a
/// seed of every entry, of which there are hundreds.
Layer MakeLayer(const PointScorer& scorer, const CandidateTable& table, std::vector<NodeSeed> others,
                bool all_revolutions);

}  // namespace millpose
