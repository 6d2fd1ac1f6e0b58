// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads a PLY, ASCII or binary of either byte order: x, y, z of the element "vertex" and the list
/// "vertex_indices" (or "vertex_index") of the element "face"; everything else is skipped. Errors as
/// ReadMesh.
RawMesh ReadPly(std::string_view bytes, const std::string& name);

bool LooksLikePly(std::string_view bytes);

}  // namespace millpose
