// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/import/step_options.hpp"
#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// What a mesh file holds, before any repair: coordinates in the file's own unit, all finite, indices in
/// range.
struct RawMesh {
  Triangles triangles;
  std::vector<std::string> bodies{};    ///< names of a STEP model's solids
  std::vector<int> body_of_source{};    ///< by source face: into `bodies`; −1 in no solid
  std::optional<double> stated_unit{};  ///< mm per unit, where the file states it (STEP)
  std::vector<std::string> notes = {};  ///< oddities that were accepted, one sentence each
};

/// Reads a mesh file (STL, OBJ, PLY, OFF) or a STEP file (step_reader.hpp); the format is told from the
/// content, not from the name. `name` is for messages. Throws InputError (line and column, or byte) for what
/// cannot be read, for numbers that are not finite and for files without triangles. Never takes memory for
/// counts that the file's size cannot hold.
RawMesh ReadMesh(std::string_view bytes, const std::string& name, const StepOptions& step = {});

}  // namespace millpose
