// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Reads a STEP file by OpenCASCADE and cuts its faces into triangles that deviate by at most
/// `chord_tolerance` (mm) and by 10 degrees. Throws std::runtime_error with one sentence, and whatever
/// OpenCASCADE throws.
RawMesh TessellateStep(std::istream& file, double chord_tolerance);

}  // namespace millpose
