// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "cad_model.hpp"

namespace millpose {

/// Reads an IGES file by OpenCASCADE. Faces outside of solids are sewn where their edges lie within 0.01 mm,
/// and what is closed then counts as a solid. Throws std::runtime_error with one sentence, and whatever
/// OpenCASCADE throws.
CadModel ReadIgesModel(const std::string& bytes);

}  // namespace millpose
