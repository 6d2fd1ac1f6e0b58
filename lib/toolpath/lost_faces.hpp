// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/region.hpp"

namespace millpose {

/// Whether a face that could not be cut into triangles may hold points of a region, by its bounds, number, id
/// and name. Where these do not tell (facing, connected) it may.
bool MayTouch(const SourceFace& face, size_t number, const RegionOptions& region);

/// Throws InputError with each lost face of the part (SourceFace::lost) that may touch the region: it would
/// stay unmilled, and the cutter could go into it.
void RefuseLostFaces(const Mesh& mesh, const RegionOptions& region);

}  // namespace millpose
