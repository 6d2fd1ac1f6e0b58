// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads the vertices and faces of a Wavefront OBJ: polygons become triangles, indices may count from the
/// end. Everything else (textures, normals, groups, curves) is ignored; keywords that are no mesh are noted
/// with their number. Errors as ReadMesh.
RawMesh ReadObj(std::string_view bytes, const std::string& name);

/// Whether the first word of a text that is no comment is one of OBJ's keywords.
bool LooksLikeObj(std::string_view bytes);

}  // namespace millpose
