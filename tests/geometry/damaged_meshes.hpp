// SPDX-License-Identifier: GPL-3.0-or-later
// Random closed meshes with what tessellators and file formats do to them.
#pragma once

#include "geometry/mesh/triangles.hpp"

namespace millpose {

inline constexpr double kDamageWeld = 1e-4;  ///< mm: damages stay within this

struct DamagedMesh {
  Triangles mesh;     ///< as a file would hold it
  Triangles indexed;  ///< before each triangle got vertices of its own, rounded anew, in half of the meshes
  double volume = 0;  ///< mm³, of the shape before it was damaged
};

/// The `number`th mesh, always the same. Up to eleven slivers, cracks without width (T-junctions, open or
/// filled by a flat triangle), vertices next to others, turned triangles; some of two bodies with a common
/// edge.
DamagedMesh MakeDamagedMesh(uint64_t number);

/// What a closed mesh encloses, in its unit cubed; negative where it is inside out.
double Volume(const Triangles& mesh);

}  // namespace millpose
