// SPDX-License-Identifier: GPL-3.0-or-later
// Values of YAML files as the judge has them, and what of a cell is its tool.
#pragma once

#include <yaml-cpp/yaml.h>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

Vector3 Triple(const YAML::Node& node);
/// Of six numbers, each times `unit`.
Angles Six(const YAML::Node& node, Real unit);
/// The frame of xyz_mm and abc_deg; what is missing is 0.
Matrix4 PoseOf(const YAML::Node& node);
/// mm, of a unit's name.
Real UnitOf(const std::string& name);

/// The job's part as its file has it; looked for from `starts`.
Mesh ReadPart(const YAML::Node& workpiece, const std::vector<std::filesystem::path>& starts);
/// How the job's part is bent, where it was registered so.
std::optional<BentPlate> ReadPlate(const YAML::Node& workpiece);

/// The cell's only tool, or the one of several that the job takes.
YAML::Node ToolOf(const YAML::Node& cell, const YAML::Node& job);
/// Columns of T in F: z along the tool, x the part of the given direction across it.
Matrix4 ToolInFlange(const YAML::Node& tool);
/// The stack as frusta; a cutter is cut in two where its cutting length ends.
void ReadTool(const YAML::Node& tool, Setup* setup);

}  // namespace millpose::audit
