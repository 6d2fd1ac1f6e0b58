// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cad_model.hpp"
#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// Cuts the faces of a model into triangles that deviate by at most `chord_tolerance` (mm) and by 10 degrees,
/// in the unit of the file. Throws std::runtime_error with one sentence, and whatever OpenCASCADE throws.
RawMesh Tessellate(CadModel model, double chord_tolerance);

}  // namespace millpose
