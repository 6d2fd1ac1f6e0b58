// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads a text OFF (also COFF, NOFF, STOFF and their mixtures; colours and normals are ignored). Errors as
/// ReadMesh.
RawMesh ReadOff(std::string_view bytes, const std::string& name);

/// Whether the first word is OFF, perhaps with the letters that announce further columns.
bool LooksLikeOff(std::string_view bytes);

}  // namespace millpose
