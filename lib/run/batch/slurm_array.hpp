// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "base/progress.hpp"

namespace millpose {

/// Commands as the tasks of array jobs of Slurm. Everything goes through a folder that all machines see: one
/// command per line of `commands.txt`, and per task what it wrote (`N.out`, `N.err`) and its exit status
/// (`N.status`). No accounting database is needed.
class SlurmArray {
 public:
  using Command = std::vector<std::string>;

  /// Writes the files into `folder`, which is emptied first.
  SlurmArray(Folder folder, std::vector<Command> commands);

  size_t size() const { return commands_.size(); }

  /// Submits all tasks; they begin when the jobs `after` have ended. `options` are further ones of sbatch.
  /// Returns the ids of the array jobs: one for each 1,000 tasks, as Slurm allows by default. Throws
  /// InputError when sbatch refuses or answers with no job id, Interrupted.
  std::vector<std::string> Submit(const std::vector<std::string>& options,
                                  const std::vector<std::string>& after, std::stop_token stop) const;

  /// Submits all tasks, waits for them, and submits those that failed (Failed) once more. Throws as Submit.
  void Run(const std::vector<std::string>& options, Progress& progress, std::stop_token stop) const;

  /// Exit status of a task; 3 when it left none.
  int StatusOf(size_t task) const;
  /// What it wrote to stderr.
  std::string ErrorsOf(size_t task) const;

  /// Waits until no job that was submitted through `folder` is in Slurm's queue any more. Throws Interrupted.
  static void WaitForEarlier(const Folder& folder, std::stop_token stop);
  /// Ids of the jobs submitted through `folder` that are in the queue.
  static std::vector<std::string> InQueue(const Folder& folder, std::stop_token stop);

 private:
  std::vector<std::string> SubmitTasks(const std::vector<size_t>& tasks,
                                       const std::vector<std::string>& options, std::stop_token stop) const;
  void Wait(const std::vector<std::string>& ids, const std::vector<size_t>& tasks, Progress& progress,
            std::stop_token stop) const;
  /// Whether a task is to be run again: killed, internal error, or no result. Bad input stays bad.
  bool Failed(size_t task) const { return StatusOf(task) > 2; }

  Folder folder_;
  std::vector<Command> commands_;
};

}  // namespace millpose
