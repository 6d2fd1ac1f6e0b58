// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>

#include "cad_model.hpp"

namespace millpose {

/// Reads a STEP file by OpenCASCADE; the memory that reading took, many times the file's size, is given back.
/// Throws std::runtime_error with one sentence, and whatever OpenCASCADE throws.
CadModel ReadStepModel(std::istream& file);

}  // namespace millpose
