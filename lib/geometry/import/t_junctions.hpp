// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Closes cracks without width: where a vertex of an open edge lies within `tolerance` (mm) of another open
/// edge, the triangle of that edge is split there. Vertices never move. How many splits were made.
size_t CloseTJunctions(Triangles& mesh, double tolerance);

}  // namespace millpose
