// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/explain_pose.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

struct InspectWords {
  std::filesystem::path folder;
  InspectOptions options;
  bool json = false;
};

std::string Told(const InspectWords& arguments) {
  RefuseSeveral(arguments.folder);
  const std::filesystem::path points_file = arguments.folder / "points.csv";
  const std::filesystem::path summary_file = arguments.folder / "summary.json";
  if (!std::filesystem::exists(points_file))
    throw InputError({arguments.folder.string()},
                     "holds no points.csv; allowed: a folder that millpose plan wrote; an interrupted plan "
                     "is finished by the same command again");
  const PointsTable points(ReadFile(points_file), points_file.string());
  const std::string summary = ReadFile(summary_file);
  CheckInspectOptions(points, arguments.options);
  PointStory story;
  if (arguments.options.point) story = TellPoint(arguments.folder, *arguments.options.point);
  const auto show = arguments.json ? InspectJson : InspectText;
  return show(points, summary, summary_file.string(), arguments.options, story);
}

int Inspect(const InspectWords& arguments) {
  std::string text;
  ReadWhole(arguments.folder, [&] { text = Told(arguments); });
  fmt::print("{}", text);
  return kDone;
}

}  // namespace

void AddInspectCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("inspect", "Show the stiffness of a plan, point by point");
  const auto arguments = std::make_shared<InspectWords>();
  command->add_option("DIR", arguments->folder, "Output folder of millpose plan")->required();
  command->add_option("--worst", arguments->options.worst, "List this many of the softest points");
  command->add_option("--point", arguments->options.point,
                      "Show this point in full (number as in points.csv)");
  command->add_option("--pass", arguments->options.pass, "Look at this pass alone");
  command->add_flag("--json", arguments->json, "JSON on standard output");
  command->callback([&run, arguments] { run = [arguments](Session&) { return Inspect(*arguments); }; });
}

}  // namespace millpose
