// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose export --gltf`: a plan as an animated scene (docs/gltf.md).
#pragma once

#include "run/pipeline/commands/export_ros.hpp"

namespace millpose {

/// Reads a plan's folder and writes `arguments.gltf`, glTF 2.0 as one binary file. Throws InputError,
/// Interrupted.
ExportOutcome ExportGltf(const ExportArguments& arguments, const Execution& execution);

}  // namespace millpose
