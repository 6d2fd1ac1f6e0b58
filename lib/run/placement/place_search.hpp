// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace millpose {

/// Asked for the value at `shares` (0..1 each); less is better. Finite.
using ValueAt = std::function<double(std::span<const double> shares)>;

/// Looks for the least value over shares with at most `evaluations` of them: four fifths by
/// NLopt's controlled random search with local mutation (Kaelo and Ali 2006), its random numbers by `seed`,
/// the rest by its Subplex (Rowan 1990) from the best. `start` is asked for first. What `value` throws ends
/// the search and is passed on.
void SearchShares(const std::vector<double>& start, int evaluations, uint64_t seed, const ValueAt& value);

}  // namespace millpose
