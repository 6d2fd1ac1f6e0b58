// SPDX-License-Identifier: GPL-3.0-or-later
// Sequences round a closed pass: branch and bound over the nodes of the first layer.
#pragma once

#include <functional>

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// The cheapest way round that starts in one of some nodes of the first layer and closes into one of them.
struct Round {
  double cost = 0;  ///< with the step that closes it
  size_t into = kNoNode;
  Sequence sequence;
};

/// The cheapest way round that closes into the node from which it started, modulo full revolutions. `round`
/// gives that of the nodes first..last−1, if there is one: it bounds all closed ones through them. `base`: of
/// the first layer. Ends with the best so far after `max_sweeps` calls.
std::optional<Sequence> BranchOverFirst(const std::vector<size_t>& base,
                                        const std::function<std::optional<Round>(size_t, size_t)>& round,
                                        int max_sweeps);

}  // namespace millpose
