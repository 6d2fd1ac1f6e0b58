// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/export_ros.hpp"

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
  const ExportOutcome outcome = ExportRos(arguments, {1, session.progress, session.stop});
  fmt::print("{}", outcome.text);
  return outcome.status;
}

}  // namespace

void AddExportCommand(CLI::App& app, Run& run) {
  CLI::App* command =
      app.add_subcommand("export", "A plan's motion and cell for other programs: ROS 2 (docs/ros.md)");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("DIR", arguments->plan, "Output folder of millpose plan")->required();
  command
      ->add_option("--ros", arguments->ros,
                   "Folder to write: joint_trajectory.yaml and .csv, cell.urdf with its meshes, cell.srdf")
      ->required();
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
