// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Faces with more corners are refused by the readers: cutting them takes time with the square of it.
inline constexpr int kMaxCorners = 1000;

/// Appends a plane (or nearly plane) polygon, given by vertices of the mesh, as triangles of the same
/// orientation, by cutting ears; polygons may be concave. Fewer than three corners append nothing.
void AppendPolygon(Triangles& mesh, const std::vector<int>& corners);

}  // namespace millpose
