// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/mesh/edges.hpp"

namespace millpose {

/// Pairs the sides of one edge of more than two triangles: which triangle goes on in which. `component`
/// numbers the pieces that hang together over edges of two triangles, `partner` (by side) takes the pairs.
/// - A component that comes to the edge with one side either way goes on in itself.
/// - Of the others each pair bounds the same material, where as many run forward as backward.
/// - What is left over stays open.
void PairAround(const Triangles& mesh, std::span<const EdgeSide> sides, const std::vector<int>& component,
                std::vector<Side>& partner);

}  // namespace millpose
