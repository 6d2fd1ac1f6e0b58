// SPDX-License-Identifier: GPL-3.0-or-later
// Repairs of a welded triangle soup that make it an oriented manifold (with rims). docs/mesh-import.md.
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Every repair with its count.
struct RepairCounts {
  size_t t_junctions = 0;            ///< triangles split at a vertex on their open edge; see CloseTJunctions
  size_t degenerate = 0;             ///< triangles as read without area, removed; see RemoveDegenerate
  size_t duplicate = 0;              ///< triangles with the vertices of an earlier one, removed
  size_t non_manifold_edges = 0;     ///< edges of more than two triangles, taken apart
  size_t non_manifold_vertices = 0;  ///< vertices in which several fans met, doubled
  size_t not_orientable_edges = 0;   ///< edges cut because no orientation fits both sides (Möbius bands)
  size_t flipped = 0;                ///< triangles turned to fit the majority of their piece
  size_t turned_pieces = 0;          ///< closed pieces that were inside out as a whole
};

/// Closes cracks without width (t_junctions.hpp) and removes triangles with a repeated vertex or a height of
/// at most `tolerance` (mm). Where a flat triangle has its middle vertex on the long edge, the neighbour over
/// that edge is split there, so that a closed mesh stays closed; one that hangs on it as a flap only goes.
void RemoveDegenerate(Triangles& mesh, double tolerance, RepairCounts& counts);

/// Removes triangles that have the same three vertices as an earlier one, in any order. In a closed mesh two
/// that are back to back both go, so that it stays closed.
void RemoveDuplicates(Triangles& mesh, RepairCounts& counts);

/// Makes an oriented manifold of triangles without degenerate ones and duplicates: pairs the sides of the
/// triangles over edges (at edges of four and more, material by material where the order around the edge is
/// consistent, else not at all), turns triangles to their piece's majority, doubles vertices in which several
/// fans meet, and turns closed pieces outside out (pieces.hpp). Geometry is never moved.
void MakeManifold(Triangles& mesh, RepairCounts& counts);

/// Drops vertices that no face uses; the others keep their order.
void DropUnusedVertices(Triangles& mesh);

}  // namespace millpose
