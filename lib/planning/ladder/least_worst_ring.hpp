// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// What is done with the sequences that a search of a ring finds: its layers are pruned between searches.
struct RingTrials {
  /// What a search finds, made as straight as it can be.
  std::function<std::optional<Sequence>(const std::function<std::optional<Sequence>()>&)> search;
  /// Whether a sequence is free of interference; else what is in its way is pruned. `round`: how many before
  /// it were not.
  std::function<bool(const Sequence&, int round)> is_free;
};

/// A free closed sequence of least worst value; empty where there is none. Proven: of the nodes that are left
/// then none has a smaller worst value, but for kWorstTolerance. By bisection: within a bound any closed
/// sequence will do, until one is free or there is none. Each is the best through some node, and so its sum
/// is small, but not the least.
std::optional<Sequence> SearchLeastWorstRing(const LadderProblem& problem, const RingTrials& trials);

}  // namespace millpose
