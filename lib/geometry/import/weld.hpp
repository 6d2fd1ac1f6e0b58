// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// What Weld did.
struct WeldCounts {
  size_t distinct = 0;  ///< vertices that differ in some bit and are used by a face
  size_t welded = 0;    ///< of these, how many went to a neighbour within the tolerance
};

/// Joins vertices that lie within `tolerance` (mm, ≥ 0) of each other: in the order of the faces each vertex
/// goes to the nearest vertex kept so far, or is kept. Kept vertices lie more than the tolerance apart and
/// are never moved; unused ones are dropped. Faces keep their order and may come out with repeated indices.
/// `body_of`, by face, where it is not empty: vertices of different bodies stay apart, wherever they lie.
Triangles Weld(const Triangles& soup, double tolerance, WeldCounts* counts,
               const std::vector<int>& body_of = {});

}  // namespace millpose
