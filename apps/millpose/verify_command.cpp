// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "run/pipeline/operations/verify_job.hpp"

namespace millpose {
namespace {

struct VerifyWords : VerifyArguments {
  bool json = false;
};

int VerifyAndPrint(const VerifyWords& arguments, Session& session) {
  const std::vector<VerifiedProgram> programs = VerifyJob(arguments, session.progress, session.stop);
  fmt::print("{}", arguments.json ? VerifyJson(programs) : VerifyText(programs));
  for (const VerifiedProgram& program : programs) {
    if (!program.findings.empty()) return kFindings;
  }
  return kDone;
}

}  // namespace

void AddVerifyCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("verify", "Read programs back and replay them through arm and cell");
  const auto arguments = std::make_shared<VerifyWords>();
  command
      ->add_option(
          "DIR|PROGRAM", arguments->target,
          fmt::format("Output folder of millpose plan: its programs against its plan; or the main file of a "
                      "program ({}): reach, limits, speeds, singularity, interference, spindle; with --plan "
                      "against its plan",
                      fmt::join(MainEndings(), ", ")))
      ->required();
  CLI::Option* cell = command->add_option("--cell", arguments->cell, "Cell of a program (YAML)");
  command
      ->add_option(
          "--plan", arguments->plan,
          "Output folder of millpose plan that a program was written in: the program, edited since or "
          "not, against that plan")
      ->excludes(cell);
  command->add_option("--tool", arguments->tool,
                      "Which of the cell's tools a program is for, where it has several");
  command->add_option("--job", arguments->job,
                      "Job that a folder was planned from (YAML), where it is not where run.json says");
  command->add_flag("--interference", arguments->interference,
                    "Check every motion for interference again, not only what leaves the plan's");
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "JSON on standard output");
  const RootOption root = AddRootOption(*command);
  command->callback([&run, arguments, root] {
    run = [arguments, root](Session& session) {
      if (arguments->plan && std::filesystem::is_directory(arguments->target))
        throw InputError(SourceLocation{arguments->target.string(), 0, 0, -1},
                         "a program expected: a folder is held against its own plan without --plan");
      arguments->root = FileRoot::Of(*root);
      return VerifyAndPrint(*arguments, session);
    };
  });
}

}  // namespace millpose
