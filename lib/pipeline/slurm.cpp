// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/slurm.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "pipeline/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

// One task of an array: a command, and the job that it belongs to.
struct Task {
  size_t job = 0;
  std::vector<std::string> command;
};

std::string Quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string ShellLine(const std::vector<std::string>& command) {
  std::string line;
  for (const std::string& word : command) line += Quoted(word) + ' ';
  return line;
}

// Every task leaves its exit status and what it wrote to stderr in files of its own: no accounting database
// is needed.
std::string Script(const fs::path& folder) {
  return fmt::format(
      "#!/bin/sh\n"
      "# Runs line SLURM_ARRAY_TASK_ID (from 0) of commands.txt.\n"
      "cd {} || exit 3\n"
      "task=$SLURM_ARRAY_TASK_ID\n"
      "command=$(sed -n \"$((task + 1))p\" commands.txt)\n"
      "eval \"$command\" > \"$task.out\" 2> \"$task.err\"\n"
      "status=$?\n"
      "echo \"$status\" > \"$task.tmp\" && mv \"$task.tmp\" \"$task.status\"\n",
      Quoted(folder.string()));
}

// One array of tasks in a folder of its own under slurm/.
class Array {
 public:
  Array(fs::path folder, std::vector<Task> tasks) : folder_(std::move(folder)), tasks_(std::move(tasks)) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::string commands;
    for (const Task& task : tasks_) commands += ShellLine(task.command) + '\n';
    WriteFileAtomically(folder_ / "commands.txt", commands);
    WriteFileAtomically(folder_ / "task.sh", Script(folder_));
  }

  const std::vector<Task>& tasks() const { return tasks_; }

  /// Submits the tasks with these indices; `extra` are options of sbatch. Returns the id of the array job.
  std::string Submit(const std::vector<size_t>& indices, const std::vector<std::string>& extra,
                     std::stop_token stop) const {
    std::vector<std::string> command{"sbatch", "--parsable", "--output=/dev/null",
                                     fmt::format("--array={}", fmt::join(indices, ","))};
    command.insert(command.end(), extra.begin(), extra.end());
    command.push_back((folder_ / "task.sh").string());
    const ProcessResult result = RunProcess(command, stop);
    const std::string id = result.output.substr(0, result.output.find_first_of(";\n"));
    // With --wait sbatch's status is the worst of the tasks: only what it says itself means that it failed.
    if (id.empty()) throw InputError(Place{"sbatch"}, fmt::format("refused the jobs: {}", result.errors));
    return id;
  }

  /// Exit status of a task; 3 when it left none.
  int StatusOf(size_t index) const {
    const fs::path file = folder_ / fmt::format("{}.status", index);
    if (!fs::exists(file)) return 3;
    const std::string text = ReadFile(file);
    const std::optional<double> status = ParseNumber(text.substr(0, text.find('\n')));
    return status ? static_cast<int>(*status) : 3;
  }

  std::string ErrorsOf(size_t index) const {
    const fs::path file = folder_ / fmt::format("{}.err", index);
    return fs::exists(file) ? ReadFile(file) : "the task left no result\n";
  }

  /// Runs all tasks and waits; those that failed (bad input apart) run once more.
  void Run(const std::vector<std::string>& extra, std::stop_token stop) const {
    std::vector<size_t> open(tasks_.size());
    for (size_t i = 0; i < open.size(); ++i) open[i] = i;
    std::vector<std::string> options{"--wait"};
    options.insert(options.end(), extra.begin(), extra.end());
    for (int attempt = 0; attempt < 2 && !open.empty(); ++attempt) {
      Submit(open, options, stop);
      std::erase_if(open, [this](size_t i) { return StatusOf(i) <= 2; });
      for (const size_t i : open) fs::remove(folder_ / fmt::format("{}.status", i));
    }
  }

 private:
  fs::path folder_;
  std::vector<Task> tasks_;
};

std::vector<size_t> All(const Array& array) {
  std::vector<size_t> indices(array.tasks().size());
  for (size_t i = 0; i < indices.size(); ++i) indices[i] = i;
  return indices;
}

std::vector<Task> ShareTasks(const std::vector<BatchJob>& jobs, const std::vector<size_t>& open,
                             const fs::path& folder, int threads, int shares) {
  std::vector<Task> tasks;
  for (const size_t job : open)
    for (int share = 0; share < shares; ++share) {
      Task task{job, PlanCommand(jobs[job], folder / jobs[job].name, threads, false)};
      task.command.push_back("--share");
      task.command.push_back(fmt::format("{}/{}", share + 1, shares));
      tasks.push_back(std::move(task));
    }
  return tasks;
}

}  // namespace

std::optional<std::vector<JobOutcome>> RunOnSlurm(const std::vector<BatchJob>& jobs, const fs::path& folder,
                                                  int threads, bool fresh, const SlurmOptions& options,
                                                  Progress& progress, std::stop_token stop) {
  std::vector<JobOutcome> outcomes(jobs.size());
  std::vector<size_t> open;
  for (size_t i = 0; i < jobs.size(); ++i) {
    const std::optional<JobOutcome> earlier = fresh ? std::nullopt : UpToDate(jobs[i], folder / jobs[i].name);
    if (earlier)
      outcomes[i] = *earlier;
    else
      open.push_back(i);
  }
  if (open.empty()) return outcomes;
  // Here and not by the tasks: one task must not remove what another has just planned.
  if (fresh)
    for (const size_t job : open) OutputFolder(folder / jobs[job].name).RemoveCheckpoints();
  std::vector<Task> whole;
  for (const size_t job : open)
    whole.push_back({job, PlanCommand(jobs[job], folder / jobs[job].name, threads, false)});
  const fs::path place = fs::absolute(folder) / "slurm";
  const Array finish(place / "jobs", std::move(whole));
  std::vector<std::string> extra = options.sbatch;
  extra.push_back(fmt::format("--cpus-per-task={}", threads));
  if (options.shares > 1) {
    const Array shares(place / "shares", ShareTasks(jobs, open, folder, threads, options.shares));
    progress.Begin("shares", 0);
    if (options.detach)
      extra.push_back("--dependency=afterany:" + shares.Submit(All(shares), extra, stop));
    else
      shares.Run(extra, stop);
    progress.End(fmt::format("{} tasks", shares.tasks().size()));
  }
  progress.Begin("jobs", 0);
  if (options.detach) {
    const std::string id = finish.Submit(All(finish), extra, stop);
    progress.End(fmt::format("{} tasks submitted as job {}", open.size(), id));
    return std::nullopt;
  }
  finish.Run(extra, stop);
  progress.End(fmt::format("{} tasks", open.size()));
  for (size_t i = 0; i < open.size(); ++i)
    outcomes[open[i]] = Judge(folder / jobs[open[i]].name, finish.StatusOf(i), finish.ErrorsOf(i));
  return outcomes;
}

}  // namespace millpose
