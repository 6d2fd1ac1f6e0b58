// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads STL, binary (also with a header that begins with "solid") or ASCII (any case, any line ends, several
/// solids). Three vertices of their own per facet; the stored normals are ignored, the order of the vertices
/// says what is outside. Errors as ReadMesh.
RawMesh ReadStl(std::string_view bytes, const std::string& name);

/// Whether the count in a binary STL's header fits the size exactly, which settles what the file is.
bool IsExactBinaryStl(std::string_view bytes);

}  // namespace millpose
