// SPDX-License-Identifier: GPL-3.0-or-later
// STEP, and IGES and 3MF with it, is read by a process of its own, millpose-step (apps/step), so that what
// OpenCASCADE or an archive does on a broken file ends as an error and nothing else. docs/mesh-import.md.
#pragma once

#include <array>

#include "geometry/import/raw_mesh.hpp"

namespace millpose {

/// What that process reads.
enum class CadFormat : int { kStep, kIges, kThreeMf };
inline constexpr std::array<CadFormat, 3> kCadFormats{CadFormat::kStep, CadFormat::kIges,
                                                      CadFormat::kThreeMf};
/// "STEP", "IGES", "3MF".
const char* NameOf(CadFormat format);

/// By the content; none where it is another kind of file.
std::optional<CadFormat> CadFormatOf(std::string_view bytes);
inline bool LooksLikeCad(std::string_view bytes) { return CadFormatOf(bytes).has_value(); }

/// The triangles of all faces of a STEP, IGES or 3MF file, with the faces that they come from and the unit
/// that the file states. Throws InputError when the file holds no face that can be read, when the process
/// crashes or exceeds its limits, and when it is not installed.
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
