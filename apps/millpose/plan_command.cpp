// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "commands.hpp"
#include "job/first_run.hpp"
#include "run/pipeline/operations/run_job.hpp"

namespace millpose {
namespace {

int Plan(const PlanArguments& arguments, Session& session) {
  const PlanOutcome outcome = RunJob(arguments, session.progress, session.stop);
  fmt::print("{}", arguments.verbose ? outcome.text : SayBrief(arguments.language, outcome.text));
  if (arguments.verbose)
    fmt::print("{}",
               FirstRunText(LoadOperations(arguments.job, arguments.overrides, arguments.root).front()));
  return outcome.exit_status;
}

// "2/8": the second of eight.
Share ParseShare(const std::string& text) {
  const size_t slash = text.find('/');
  const std::optional<double> number = ParseNumber(text.substr(0, slash));
  const std::optional<double> count =
      slash == std::string::npos ? std::nullopt : ParseNumber(text.substr(slash + 1));
  const bool whole = number && count && *number == std::floor(*number) && *count == std::floor(*count);
  if (!whole || *number < 1 || *number > *count || *count > 1e6)
    throw InputError(SourceLocation{},
                     fmt::format("--share: given {}; allowed: K/N with K from 1 to N", text));
  return {static_cast<size_t>(*number) - 1, static_cast<size_t>(*count)};
}

}  // namespace

void AddPlanCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("plan", "Plan a job and write programs, points and reports");
  const auto arguments = std::make_shared<PlanArguments>();
  command->add_option("JOB", arguments->job, "Job file (YAML)")->required();
  command->add_option("-o,--out", arguments->out, "Output folder; default: <job name>.out next to the job");
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of all random numbers in place of the job's")
      ->check(CLI::Range(0.0, 9007199254740992.0));
  const auto changes = std::make_shared<std::vector<std::string>>();
  command->add_option("--set", *changes,
                      "KEY=VALUE: a setting in place of the job's, like toolpath.stepover_mm=4");
  const auto share = std::make_shared<std::string>();
  command->add_option("--share", *share,
                      "K/N: plan only every N-th pass from the K-th, as checkpoints, and end");
  command->add_flag("--audit", arguments->audit, "Judge the plan by recomputation; figures in summary.json");
  command->add_flag(
      "--face", arguments->face,
      "Predict the face that the plan will leave, as `millpose face` does: face.csv, summary.json, "
      "report.html");
  const auto axis_map = std::make_shared<std::string>("known");
  command
      ->add_option(
          "--axis-map", *axis_map,
          "full: check every pose of report.html's axis map for interference; known: show what the plan "
          "learned")
      ->check(CLI::IsMember({"known", "full"}))
      ->capture_default_str();
  command
      ->add_option("--trajectory", arguments->trajectory,
                   "Write trajectory-<controller>.csv too, a row every so many s and at every point")
      ->check(CLI::Range(1e-3, 1e4))
      ->type_name("SECONDS");
  command->add_flag(
      "-v,--verbose", arguments->verbose,
      "Print all figures, warnings and findings, and what to check by hand at each controller before a "
      "first run");
  command->add_flag("--fresh", arguments->fresh, "Ignore checkpoints of earlier runs");
  command->add_option("--max-points", arguments->max_points, "Points that the tool path may have")
      ->check(CLI::Range(1.0, 1e9))
      ->capture_default_str();
  const LanguageOption language = AddLanguageOption(*command);
  const RootOption root = AddRootOption(*command);
  command->callback([&run, arguments, changes, share, axis_map, language, root] {
    run = [arguments, changes, share, axis_map, language, root](Session& session) {
      arguments->language = ParseLanguage(*language);
      arguments->root = FileRoot::Of(*root);
      if (!share->empty()) arguments->share = ParseShare(*share);
      arguments->full_axis_map = *axis_map == "full";
      for (const std::string& change : *changes) arguments->overrides.push_back(ParseOverride(change));
      return Plan(*arguments, session);
    };
  });
}

}  // namespace millpose
