// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "pipeline/run.hpp"

namespace millpose {
namespace {

int Plan(const PlanArguments& arguments, Session& session) {
  try {
    const PlanOutcome outcome = RunPlan(arguments, session.progress, session.stop);
    fmt::print("{}", outcome.text);
    return outcome.exit_status;
  } catch (const Interrupted&) {
    fmt::print(stderr, "millpose: finished passes are kept; the same command goes on from there\n");
    throw;
  }
}

}  // namespace

void AddPlanCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("plan", "Plan a job and write programs, points and reports");
  const auto arguments = std::make_shared<PlanArguments>();
  command->add_option("JOB", arguments->job, "Job file (YAML)")->required();
  command->add_option("-o,--out", arguments->out, "Output folder; default: <job name>.out beside the job");
  command->add_option("--threads", arguments->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of all random numbers in place of the job's");
  const auto changes = std::make_shared<std::vector<std::string>>();
  command->add_option("--set", *changes,
                      "KEY=VALUE: a setting in place of the job's, like toolpath.stepover_mm=4");
  command->add_flag("--audit", arguments->audit, "Judge the plan by recomputation; figures in summary.json");
  command->add_flag("--fresh", arguments->fresh, "Ignore checkpoints of earlier runs");
  command->callback([&run, arguments, changes] {
    run = [arguments, changes](Session& session) {
      for (const std::string& change : *changes) arguments->overrides.push_back(ParseOverride(change));
      return Plan(*arguments, session);
    };
  });
}

}  // namespace millpose
