// SPDX-License-Identifier: GPL-3.0-or-later
// Where no fixed rotation serves all points: the one that serves most of them.
#pragma once

#include <stop_token>

#include "planning/pass/fixed_table.hpp"

namespace millpose {

/// A rotation of a grid, and the planned points of each pass at which no branch of it is admissible.
struct MissingPoints {
  size_t rotation = 0, count = 0;
  std::vector<std::vector<size_t>> of_pass;  ///< ascending
};

/// Of all rotations of `grid`'s the one that leaves fewest points without a pose, of equals the first.
/// Looks at few points first, and at the others only for rotations that may still be that one.
MissingPoints FewestMissing(const Stations& stations, std::span<const PassResult* const> passes,
                            const FixedTable& grid, int threads, std::stop_token stop);

}  // namespace millpose
