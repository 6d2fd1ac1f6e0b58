// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "run/placement/run_place.hpp"

namespace millpose {

void AddPlaceCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "place",
      "Search the place where the part is milled best, plan the best places completely, write the best "
      "as JOB.placed.yaml (docs/placement.md)");
  const auto arguments = std::make_shared<PlaceArguments>();
  command->add_option("JOB", arguments->job, "Job file (YAML) with a section placement")->required();
  command->add_option("-o,--out", arguments->out,
                      "Output folder; default: <job name>.places next to the job");
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  const auto changes = std::make_shared<std::vector<std::string>>();
  command->add_option("--set", *changes,
                      "KEY=VALUE: a setting in place of the job's, like placement.places=500");
  command->add_option("--max-points", arguments->max_points, "Points that the tool path may have")
      ->check(CLI::Range(1.0, 1e9))
      ->capture_default_str();
  const LanguageOption language = AddLanguageOption(*command);
  const RootOption root = AddRootOption(*command);
  command->callback([&run, arguments, changes, language, root] {
    run = [arguments, changes, language, root](Session& session) {
      arguments->language = ParseLanguage(*language);
      arguments->root = FileRoot::Of(*root);
      for (const std::string& change : *changes) arguments->overrides.push_back(ParseOverride(change));
      const PlanOutcome outcome = RunPlace(*arguments, session.progress, session.stop);
      fmt::print("{}", outcome.text);
      return outcome.exit_status;
    };
  });
}

}  // namespace millpose
