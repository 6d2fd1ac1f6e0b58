// SPDX-License-Identifier: GPL-3.0-or-later
// Material over a surface as heights along its normals (docs/face.md).
#pragma once

#include <vector>

#include "toolpath/region.hpp"

namespace millpose {

/// A place of a surface and the direction along which material over it is measured. Frame P, mm.
struct SurfaceRay {
  Eigen::Vector3d origin;  ///< on the mesh
  Eigen::Vector3d normal;  ///< unit, out of the material: its face's
  /// Where it stands on its lattice: the axis that the normal is nearest to (0..2, +3 where it points against
  /// it), and the steps along the next two axes.
  int side = 0, i = 0, j = 0;
};

/// Rays on the faces of a region. From each of the six directions of the axes a face is seen as a square
/// lattice of `spacing` (mm), whichever of them its normal is nearest to; on the face rays are then up to √3
/// times as far apart. Sorted by side, i, j, and along the axis; those of one place only once.
std::vector<SurfaceRay> RaysOver(const Region& region, double spacing);

/// About how many that makes: the area seen from the axes ÷ spacing².
double CountRays(const Region& region, double spacing);

/// Neighbours on the surface: for each ray the next one along i and along j, −1 where there is none within
/// twice the spacing.
std::vector<std::array<int, 2>> NextRays(const std::vector<SurfaceRay>& rays, double spacing);

}  // namespace millpose
