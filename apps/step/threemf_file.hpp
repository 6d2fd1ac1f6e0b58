// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads the meshes that a 3MF file (a zip archive) builds, each where its item and components put it. One
/// alone comes as from an STL file; of several each is a body and a source face of kind "mesh". In the file's
/// unit where jobs can name it, else mm. Throws std::runtime_error with one sentence: part of the archive,
/// line, what is wrong.
RawMesh ReadThreeMf(std::string_view bytes);

}  // namespace millpose
