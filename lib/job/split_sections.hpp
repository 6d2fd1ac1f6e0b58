// SPDX-License-Identifier: GPL-3.0-or-later
// A CAM file for several tools or speeds as operations of a job.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "job/inputs.hpp"
#include "toolpath/cam/cam_source.hpp"

namespace millpose {

/// The sections of the CAM file that the job's strategy reads, in the file's order. Throws InputError for a
/// job of another strategy and for what cannot be read.
std::vector<CamSection> SectionsOf(const JobInputs& inputs);

/// The name of the cell's tool that has a section's cutter (diameter to 0.001 mm and corner), else, where the
/// file states no cutter, its number or name; of several the one with the file's number. Empty where the cell
/// has one tool without a choice, and it is the one. Throws InputError with what the cell has.
std::string ToolOfSection(const CamSection& section, size_t number, const CellSettings& cell,
                          const std::string& file);

/// `job_yaml`, which `inputs` were read from, with an operation for each section in place of its `tool` and
/// `toolpath`; everything else stays as it is written. Throws InputError where there are not two sections at
/// least, and as the functions above.
std::string SplitIntoOperations(std::string_view job_yaml, const JobInputs& inputs);

}  // namespace millpose
