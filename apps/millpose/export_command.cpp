// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/export_gltf.hpp"

namespace millpose {
namespace {

/// A package's name as ROS allows it; empty for none.
void CheckPackage(const std::string& name) {
  const bool plain = std::ranges::all_of(
      name, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
  if (name.empty() || (plain && name.front() >= 'a' && name.front() <= 'z')) return;
  throw InputError(SourceLocation{},
                   fmt::format("--package: given {}; allowed: a letter, then a to z, 0 to 9 and _", name));
}

int Export(const ExportArguments& arguments, Session& session) {
  CheckPackage(arguments.package);
  if (arguments.ros.empty() && arguments.gltf.empty())
    throw InputError(SourceLocation{}, "--ros FOLDER or --gltf FILE: missing; needed: at least one of them");
  if (arguments.ros.empty() && !arguments.package.empty())
    throw InputError(SourceLocation{}, "--package: has no effect without --ros");
  int status = 0;
  for (const auto& [asked, make] :
       {std::pair(!arguments.ros.empty(), &ExportRos), std::pair(!arguments.gltf.empty(), &ExportGltf)}) {
    if (!asked) continue;
    const ExportOutcome outcome = make(arguments, {1, session.progress, session.stop});
    fmt::print("{}", outcome.text);
    status = std::max(status, outcome.status);
  }
  return status;
}

}  // namespace

void AddExportCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("export",
                                         "A plan's motion and cell for other programs: ROS 2 (docs/ros.md), "
                                         "an animated scene (docs/gltf.md)");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("DIR", arguments->plan, "Output folder of millpose plan")->required();
  command->add_option(
      "--ros", arguments->ros,
      "Folder to write: joint_trajectory.yaml and .csv, cell.urdf with its meshes, cell.srdf");
  command->add_option("--gltf", arguments->gltf,
                      "File to write, .glb: the cell and its run as an animation, glTF 2.0");
  command->add_option(
      "--package", arguments->package,
      "ROS package that the folder will be: meshes are named package://PACKAGE/meshes/…, else "
      "relative to cell.urdf");
  command->add_option("--job", arguments->job.emplace(), "Its job file, if that is not next to the folder");
  const RootOption root = AddRootOption(*command);
  command->callback([&run, arguments, root] {
    run = [arguments, root](Session& session) {
      if (arguments->job->empty()) arguments->job.reset();
      arguments->root = FileRoot::Of(*root);
      return Export(*arguments, session);
    };
  });
}

}  // namespace millpose
