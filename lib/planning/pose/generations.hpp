// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pose/search.hpp"

namespace millpose {

/// What the generations of GeneticSearch() with the same arguments come to, without the refinement behind
/// them, which costs more than they do.
std::vector<GenerationRecord> Generations(const PointScorer& scorer, const PoseProblem& problem,
                                          const GeneticOptions& options, RandomStream stream);

}  // namespace millpose
