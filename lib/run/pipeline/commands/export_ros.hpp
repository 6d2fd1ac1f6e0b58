// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose export --ros`: a plan's motion and cell for ROS 2 (docs/ros.md).
#pragma once

#include <filesystem>

#include "base/execution.hpp"
#include "base/file_root.hpp"
#include "report/ros/cell_urdf.hpp"
#include "report/ros/joint_trajectory.hpp"
#include "run/pipeline/commands/plan_folder.hpp"

namespace millpose {

struct ExportArguments {
  std::filesystem::path plan;                ///< output folder of the plan
  std::optional<std::filesystem::path> job;  ///< of it, where it does not stand beside the folder
  std::filesystem::path ros;                 ///< folder to write, for ExportRos()
  std::filesystem::path gltf;                ///< file to write, for ExportGltf()
  std::string package;                       ///< of ROS, that meshes are named by; empty: relative
  FileRoot root{};
};

/// What is written.
struct RosExport {
  Cell cell;
  RosNames names;
  MotionProgram program;
  std::vector<TrajectoryInstant> run;
  CellUrdf urdf;
  std::map<std::string, std::string> files;  ///< all of it, by name in the folder
  std::vector<std::string> beyond;           ///< BeyondLimits: nothing is to be written then
};

/// Precondition: WhyNotProgrammable(plan) is empty. Throws InputError where the points of a dry run are out
/// of reach, and for what the part's mesh is refused for.
RosExport MakeRosExport(const PlanResult& plan, const JobInputs& inputs, const std::string& package);

struct ExportOutcome {
  int status = 0;    ///< 1: the plan does not allow it, and nothing is written
  std::string text;  ///< what came out, or why not
};
/// Reads a plan's folder and writes the other. Throws InputError, Interrupted.
ExportOutcome ExportRos(const ExportArguments& arguments, const Execution& execution);

}  // namespace millpose
