// SPDX-License-Identifier: GPL-3.0-or-later
// OpenCASCADE calls the C library's trigonometry, so two machines may cut a STEP file into different
// triangles. The triangles therefore are an input of their own: cut once, kept in the output folder, taken
// from there by whoever plans or verifies in it again. docs/mesh-import.md.
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "job/inputs.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// Of STEP files among the inputs those whose triangles a folder's results or checkpoints hold become these.
void TakeCachedMeshes(const std::filesystem::path& folder, JobInputs* inputs);
void TakeCachedMeshes(const OutputFolder& folder, JobInputs* inputs);

/// Cuts the STEP files that are left. `percent` hears how far it has come. Throws InputError, also for a
/// stock or body of which a face is lost; Interrupted.
void CutStepFiles(JobInputs* inputs, const std::function<void(int)>& percent, const std::stop_token& stop);

/// Keeps the triangles beside the checkpoints, for a run that goes on after this one.
void KeepMeshes(const JobInputs& inputs, const OutputFolder& folder);
/// Adds them to the results, where the manifest names each with its hash.
void AddMeshes(const JobInputs& inputs, ResultSet* results);

}  // namespace millpose
