// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles to look at: shapes of a cell tessellated, large meshes thinned. For pictures only.
#pragma once

#include <cstddef>

#include "machine/collision/cell.hpp"

namespace millpose {

/// Triangles of a shape in its own frame, mm; round shapes by chords of 15°.
Triangles ViewMesh(const Shape& shape);

/// The convex hull of points, facets counter-clockwise seen from outside; empty when they span no volume.
Triangles ConvexHull(const std::vector<Eigen::Vector3d>& points);

/// At most `max_faces` triangles that look like `mesh`: vertices in one cell of a grid become their mean, and
/// faces that collapse go (vertex clustering, Rossignac and Borrel 1993). The grid is as fine as the number
/// allows.
Triangles ThinnedMesh(const Triangles& mesh, size_t max_faces);

}  // namespace millpose
