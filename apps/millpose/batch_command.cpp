// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "run/batch/batch.hpp"
#include "store/output_folder.hpp"

namespace millpose {

void AddBatchCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("batch", "Plan many jobs; those that are up to date are skipped");
  const auto arguments = std::make_shared<BatchArguments>();
  command
      ->add_option("JOBS", arguments->jobs, "Job files, manifests (millpose_batch: 1), folders, 'patterns*'")
      ->required();
  command
      ->add_option("-o,--out", arguments->out,
                   "Folder of all results, index.html, batch.csv, batch.json, junit.xml")
      ->capture_default_str();
  command
      ->add_option("--threads", arguments->threads,
                   "Threads of all jobs together, 0: all cores; with --slurm of each task, 0: one")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--parallel", arguments->parallel, "Jobs at a time; 0: as many as threads")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--memory-MB", arguments->memory_MB, "Memory of all jobs together, MB; 0: no bound")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--fresh", arguments->fresh, "Ignore checkpoints and what is done");
  command->add_option("--baseline", arguments->baseline,
                      "Folder of an earlier batch: what differs from its plans joins each job's remarks");
  const auto use_slurm = std::make_shared<bool>(false);
  const auto slurm = std::make_shared<SlurmOptions>();
  command->add_flag("--slurm", *use_slurm, "Plan by array jobs of Slurm on a folder that all machines share");
  command
      ->add_option(
          "--shares", slurm->shares,
          "With --slurm: tasks over which a job's passes are spread, where the manifest does not say")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--detach", slurm->detach,
                    "With --slurm: submit and end; the same command later gathers");
  command->add_option("--sbatch", slurm->sbatch,
                      "With --slurm: a further option of sbatch, like --partition=cpu");
  command->add_option("--max-points", arguments->max_points, "Points that the tool path of a job may have")
      ->check(CLI::Range(1.0, 1e9))
      ->capture_default_str();
  const LanguageOption language = AddLanguageOption(*command);
  const RootOption root = AddRootOption(*command);
  command->callback([&run, arguments, use_slurm, slurm, language, root] {
    run = [arguments, use_slurm, slurm, language, root](Session& session) {
      arguments->language = ParseLanguage(*language);
      arguments->root = FileRoot::Of(*root);
      if (*use_slurm) arguments->slurm = *slurm;
      if (!arguments->baseline.empty() && !IsOutputFolder(arguments->baseline))
        throw InputError({arguments->baseline.string()},
                         "is no output folder of millpose (it has no .millpose)");
      arguments->tell_running = session.doing;
      arguments->tell_left = session.left_by;
      const BatchOutcome outcome = RunBatch(*arguments, session.progress, session.stop);
      fmt::print("{}", outcome.text);
      return outcome.exit_status;
    };
  });
}

}  // namespace millpose
