// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "init/init.hpp"

namespace millpose {
namespace {

const std::map<std::string, double> kUnits{{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}};

int Init(InitArguments arguments, const std::string& unit, Session& session) {
  if (!unit.empty()) arguments.unit = kUnits.at(unit);
  fmt::print("{}", RunInit(arguments, session.progress, session.stop).text);
  return kDone;
}

}  // namespace

void AddInitCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "init", "Write a first cell and job for a part and an arm, which can be planned right away");
  const auto arguments = std::make_shared<InitArguments>();
  const auto unit = std::make_shared<std::string>();
  command->add_option("PART", arguments->part, "Part (STL, OBJ, PLY, OFF, STEP)")->required();
  command->add_option("--arm", arguments->arm, "A sample cell's arm, like kr500_r2830, or a URDF file")
      ->required();
  command->add_option("-o,--out", arguments->out,
                      "Folder for cell.yaml and job.yaml; default: the part's name, here");
  command->add_option("--unit", *unit, "Unit of the part: mm, cm, in, m; by default the file's, else mm")
      ->check(CLI::IsMember({"mm", "cm", "in", "m"}));
  command->add_option("--base-link", arguments->base_link, "Of a URDF: the link that the arm stands on");
  command->add_option("--flange-link", arguments->flange_link, "Of a URDF: the link that the tool hangs on");
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->callback([&run, arguments, unit] {
    run = [arguments, unit](Session& session) { return Init(*arguments, *unit, session); };
  });
}

}  // namespace millpose
