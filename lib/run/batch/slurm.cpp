// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/slurm.hpp"

#include "run/batch/slurm_array.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Command = SlurmArray::Command;

// The command with `--share K/N` for each K; nothing where there is one share.
void AddShares(const Command& command, int shares, std::vector<Command>* commands) {
  for (int share = 1; share <= shares && shares > 1; ++share) {
    commands->push_back(command);
    commands->back().push_back("--share");
    commands->back().push_back(fmt::format("{}/{}", share, shares));
  }
}

// What an earlier call of the same command submitted must have ended before two tasks write into one folder.
// Returns the ids of what runs, when it is not waited for.
std::vector<std::string> TakeUpEarlier(const Folder& place, bool wait, Progress& progress,
                                       const std::stop_token& stop) {
  std::vector<std::string> ids;
  for (const char* name : {"shares", "jobs"}) {
    const std::optional<Folder> earlier = place.FindBelow(name);
    if (!earlier) continue;
    const std::vector<std::string> running = SlurmArray::InQueue(*earlier, stop);
    ids.insert(ids.end(), running.begin(), running.end());
  }
  if (ids.empty() || !wait) return ids;
  progress.Begin("submitted", 0);
  for (const char* name : {"shares", "jobs"})
    if (const std::optional<Folder> earlier = place.FindBelow(name))
      SlurmArray::WaitForEarlier(*earlier, stop);
  progress.End(fmt::format("jobs {} of an earlier call", fmt::join(ids, ", ")));
  return {};
}

// All at once, each after the one before: shares, jobs, and the jobs again, where a task that has its result
// ends at once.
std::string SubmitAll(const std::optional<SlurmArray>& shares, const SlurmArray& finish,
                      const std::vector<std::string>& options, const std::stop_token& stop) {
  std::vector<std::string> after;
  if (shares) after = shares->Submit(options, {}, stop);
  const std::vector<std::string> first = finish.Submit(options, after, stop);
  finish.Submit(options, first, stop);
  return fmt::format("{} jobs submitted as {}; the same command without --detach gathers the results\n",
                     finish.size(), fmt::join(first, ", "));
}

}  // namespace

std::variant<std::vector<JobOutcome>, std::string> RunOnSlurm(const std::vector<BatchJob>& jobs,
                                                              const fs::path& folder, int threads, bool fresh,
                                                              const SlurmOptions& options, Progress& progress,
                                                              std::stop_token stop) {
  const Folder place = Folder(fs::absolute(folder)).MakeBelow("slurm");
  const std::vector<std::string> running = TakeUpEarlier(place, !options.detach, progress, stop);
  if (!running.empty())
    return fmt::format("jobs {} of an earlier call still run; the same command without --detach waits\n",
                       fmt::join(running, ", "));

  std::vector<JobOutcome> outcomes(jobs.size());
  std::vector<size_t> open;
  std::vector<Command> whole, parts;
  for (size_t i = 0; i < jobs.size(); ++i) {
    const fs::path out = folder / jobs[i].name;
    const std::optional<JobOutcome> earlier = fresh ? std::nullopt : UpToDate(jobs[i], out);
    if (earlier) {
      outcomes[i] = *earlier;
      continue;
    }
    // Here and not by the tasks: one task must not remove what another has just planned.
    if (fresh) OutputFolder(out, FolderUse::kResults).RemoveCheckpoints();
    open.push_back(i);
    whole.push_back(PlanCommand(jobs[i], out, threads, false));
    AddShares(whole.back(), jobs[i].shares > 0 ? jobs[i].shares : options.shares, &parts);
  }
  if (open.empty()) return outcomes;

  std::vector<std::string> extra = options.sbatch;
  extra.push_back(fmt::format("--cpus-per-task={}", threads));
  std::optional<SlurmArray> shares;
  if (!parts.empty()) shares.emplace(place.MakeBelow("shares"), std::move(parts));
  const SlurmArray finish(place.MakeBelow("jobs"), std::move(whole));
  if (options.detach) return SubmitAll(shares, finish, extra, stop);
  const auto run = [&](const char* name, const SlurmArray& array) {
    progress.Begin(name, array.size());
    array.Run(extra, progress, stop);
    progress.End(fmt::format("{} tasks", array.size()));
  };
  if (shares) run("shares", *shares);
  run("jobs", finish);
  for (size_t i = 0; i < open.size(); ++i)
    outcomes[open[i]] = Judge(folder / jobs[open[i]].name, finish.StatusOf(i), finish.ErrorsOf(i));
  return outcomes;
}

}  // namespace millpose
