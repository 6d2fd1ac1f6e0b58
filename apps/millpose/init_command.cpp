// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "run/init/init.hpp"

namespace millpose {
namespace {

int Init(InitArguments arguments, const UnitOption& unit, Session& session) {
  arguments.unit = MillimetresOf(unit);
  if (arguments.arm.empty() && !arguments.cell)
    throw InputError(SourceLocation{}, "given neither --arm nor --cell; needed: one of the two");
  arguments.say = [](const std::string& text) {
    fmt::print("{}", text);
    std::fflush(stdout);
  };
  fmt::print("{}", RunInit(arguments, session.progress, session.stop).text);
  return kDone;
}

}  // namespace

void AddInitCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "init", "Write a first cell and job for a part and an arm, which can be planned right away");
  const auto arguments = std::make_shared<InitArguments>();
  command
      ->add_option("PART", arguments->part,
                   "Part (STL, OBJ, PLY, OFF, STEP, IGES, 3MF), or a CAM file (APT, G-code, CSV)")
      ->required();
  CLI::Option* arm =
      command->add_option("--arm", arguments->arm, "A sample cell's arm, like kr500_r2830, or a URDF file");
  CLI::Option* cell = command->add_option(
      "--cell", arguments->cell,
      "Your own cell in place of an arm, with its rail and tools: only the job is written");
  command->add_option("--tool", arguments->tool, "Of --cell: which of its tools; default: the first")
      ->needs(cell);
  arm->excludes(cell);
  command->add_option("-o,--out", arguments->out,
                      "Folder for cell.yaml and job.yaml; default: the part's name, here");
  const UnitOption unit = AddUnitOption(*command);
  command->add_option("--base-link", arguments->base_link, "Of a URDF: the link that the arm stands on");
  command->add_option("--flange-link", arguments->flange_link, "Of a URDF: the link that the tool hangs on");
  command
      ->add_option(
          "--tolerance-mm", arguments->tolerance,
          "Of a URDF: how far its joints may be off a closed form, as calibrated ones are; 0.01 by default")
      ->check(CLI::Range(1e-9, 10.0));
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->callback([&run, arguments, unit] {
    run = [arguments, unit](Session& session) { return Init(*arguments, unit, session); };
  });
}

}  // namespace millpose
