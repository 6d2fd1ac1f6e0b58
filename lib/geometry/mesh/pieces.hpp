// SPDX-License-Identifier: GPL-3.0-or-later
// The connected pieces of a finished mesh: the one place that says which are closed and where outside is.
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// A connected piece of an oriented manifold.
struct ConnectedPiece {
  std::vector<int> faces;  ///< the lowest first
  bool closed = true;      ///< without a rim: outside is certain
};

/// The pieces of an oriented manifold (MakeManifold), by their lowest face.
std::vector<ConnectedPiece> PiecesOf(const Triangles& manifold);

/// Turns closed pieces that are inside out as a whole, unless they lie in an odd number of other closed
/// pieces: those are cavities. How many pieces were turned.
size_t TurnPiecesOutside(Triangles& manifold);

/// Turns every piece of a manifold that is open at a rim, of which nobody can tell outside from inside, the
/// other way round. How many triangles were turned.
size_t FlipOpenPieces(Triangles& manifold);

}  // namespace millpose
