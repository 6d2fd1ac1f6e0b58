// SPDX-License-Identifier: GPL-3.0-or-later
// STEP is read by a process of its own, millpose-step (apps/step), so that what OpenCASCADE does with a
// broken file ends as an error and nothing else. docs/mesh-import.md.
#pragma once

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

bool LooksLikeStep(std::string_view bytes);

/// The triangles of all faces of a STEP file, with the faces that they come from and the unit that the file
/// states. Throws InputError when the file holds no face that can be read, when the process crashes or
/// exceeds its limits, and when it is not installed.
RawMesh ReadStep(std::string_view bytes, const std::string& name, const StepOptions& options);

/// As ReadStep, the answer as it comes: for ReadStepTriangles.
std::string CutStep(std::string_view bytes, const std::string& name, const StepOptions& options);

/// What such an answer begins with; the same on every machine, as the numbers in it are (little-endian).
inline constexpr std::string_view kStepTriangles = "millpose-step-3";
bool IsStepTriangles(std::string_view bytes);

/// What passes between the two processes: triangles in the file's unit. The reader trusts nothing in it.
std::string WriteStepTriangles(const RawMesh& mesh);
RawMesh ReadStepTriangles(std::string_view bytes, const std::string& name);

}  // namespace millpose
