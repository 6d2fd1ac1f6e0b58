// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Joins vertices that lie within `tolerance` (mm, ≥ 0) of each other: in the order of the faces each vertex
/// goes to the nearest vertex kept so far, or is kept. Kept vertices lie more than the tolerance apart and
/// are never moved; unused ones are dropped. Faces keep their order and may come out with repeated indices.
/// `joined`, where it is given: how many vertices that differ in some bit and are used by a face went to a
/// neighbour. `body_of`, by face, where it is not empty: vertices of different bodies stay apart, wherever
/// they lie.
Triangles Weld(const Triangles& soup, double tolerance, size_t* joined, const std::vector<int>& body_of = {});

}  // namespace millpose
