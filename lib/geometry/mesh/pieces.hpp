// SPDX-License-Identifier: GPL-3.0-or-later
// The connected pieces of a finished mesh: the one place that says which are closed and where outside is.
#pragma once

#include "geometry/mesh/edges.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A connected piece of an oriented manifold.
struct ConnectedPiece {
  std::vector<int> faces;  ///< the lowest first
  bool closed = true;      ///< without a rim: outside is certain
};

/// The pieces of a mesh, by their lowest face.
std::vector<ConnectedPiece> PiecesOf(const Mesh& mesh);

/// Turns closed pieces that are inside out as a whole, unless they lie in an odd number of other closed
/// pieces: those are cavities. `partners`: as PartnersOf(manifold). How many pieces were turned.
size_t TurnPiecesOutside(const std::vector<Side>& partners, Triangles& manifold);

/// Turns every piece of a manifold that is open at a rim, of which nobody can tell outside from inside, the
/// other way round. How many triangles were turned.
size_t FlipOpenPieces(Triangles& manifold);

}  // namespace millpose
