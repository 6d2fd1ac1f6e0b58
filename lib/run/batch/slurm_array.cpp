// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/slurm_array.hpp"

#include <chrono>
#include <numeric>
#include <thread>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/process.hpp"
#include "base/shown.hpp"
#include "base/text.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using namespace std::chrono_literals;
constexpr size_t kTasksPerArray = 1000;  // Slurm's MaxArraySize is 1001 by default
constexpr auto kFirstPause = 200ms, kLongestPause = 5000ms;
constexpr int kLooksAfterEnd = 3;  // a shared folder may show a file a little late
constexpr const char* kSubmitted = "submitted";

// A word of a command for the shell. A line of commands.txt is a task: what would break the line is refused.
std::string ShellWord(const std::string& word) {
  if (std::ranges::any_of(word, [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; }))
    throw InputError(
        SourceLocation{Shown(word)},
        "holds a control character (a line feed, a tab, …); allowed with --slurm: names without");
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string ShellLine(const std::vector<std::string>& command) {
  std::string line;
  for (const std::string& word : command) line += ShellWord(word) + ' ';
  return line;
}

std::string Script(const fs::path& folder) {
  return fmt::format(
      "#!/bin/sh\n"
      "# usage: task.sh FIRST: runs line FIRST + SLURM_ARRAY_TASK_ID (from 0) of commands.txt, unless it has "
      "a\n"
      "# result already.\n"
      "cd {} || exit 3\n"
      "task=$(($1 + SLURM_ARRAY_TASK_ID))\n"
      "case \"$(cat \"$task.status\" 2> /dev/null)\" in 0 | 1 | 2) exit 0 ;; esac\n"
      "command=$(sed -n \"$((task + 1))p\" commands.txt)\n"
      "eval \"$command\" > \"$task.out\" 2> \"$task.err\"\n"
      "status=$?\n"
      "echo \"$status\" > \"$task.tmp\" && mv \"$task.tmp\" \"$task.status\"\n",
      ShellWord(folder.string()));
}

void Pause(std::chrono::milliseconds time, const std::stop_token& stop) {
  for (; time > 0ms; time -= 50ms) {
    CheckStop(stop);
    std::this_thread::sleep_for(std::min(time, std::chrono::milliseconds(50ms)));
  }
}

// The id that `sbatch --parsable` answers with: "ID" or "ID;CLUSTER", in one line. Anything else submitted
// nothing that could be waited for.
std::string IdOf(const std::string& answer) {
  const std::string line = answer.substr(0, answer.find('\n'));
  std::string id = line.substr(0, line.find(';'));
  const bool is_id = !id.empty() && std::ranges::all_of(id, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_id || answer.size() > line.size() + 1)
    throw InputError(
        SourceLocation{"sbatch"},
        fmt::format("answered \"{}\", which is no job id; allowed: what sbatch --parsable prints, "
                    "like 4711 or 4711;cluster",
                    Shown(answer)));
  return id;
}

std::string StatusFile(size_t task) { return fmt::format("{}.status", task); }

// A file's content; `none` where there is no such file.
std::string ReadOr(const Folder& folder, const std::string& name, const std::string& none) {
  return folder.KindOf(name) == Folder::Kind::kNothing ? none : folder.Read(name);
}

// Whether Slurm still has the job waiting or running. A controller that does not answer is no answer: yes.
bool IsQueued(const std::string& id, const std::stop_token& stop) {
  const ProcessResult result = RunProcess({"squeue", "--noheader", "--jobs=" + id, "--format=%i"}, stop);
  if (result.status == 0) return !result.output.empty();
  return result.errors.find("Invalid job id") == std::string::npos;
}

}  // namespace

SlurmArray::SlurmArray(Folder folder, std::vector<Command> commands)
    : folder_(std::move(folder)), commands_(std::move(commands)) {
  for (const std::string& name : folder_.Names()) folder_.RemoveAll(name);
  std::string lines;
  for (const Command& command : commands_) lines += ShellLine(command) + '\n';
  folder_.Write("commands.txt", lines);
  folder_.Write("task.sh", Script(folder_.path()));
}

std::vector<std::string> SlurmArray::SubmitTasks(const std::vector<size_t>& tasks,
                                                 const std::vector<std::string>& options,
                                                 std::stop_token stop) const {
  std::vector<std::string> ids;
  for (size_t at = 0; at < tasks.size();) {
    const size_t first = tasks[at] / kTasksPerArray * kTasksPerArray;
    std::vector<size_t> indices;
    for (; at < tasks.size() && tasks[at] < first + kTasksPerArray; ++at)
      indices.push_back(tasks[at] - first);
    Command command{"sbatch", "--parsable", "--job-name=millpose", "--output=/dev/null",
                    fmt::format("--array={}", fmt::join(indices, ","))};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back((folder_.path() / "task.sh").string());
    command.push_back(std::to_string(first));
    const ProcessResult result = RunProcess(command, stop);
    if (result.status != 0)
      throw InputError(SourceLocation{"sbatch"},
                       fmt::format("refused the tasks: {}", Shown(result.errors, 400)));
    ids.push_back(IdOf(result.output));
    folder_.Write(kSubmitted, ReadOr(folder_, kSubmitted, "") + ids.back() + '\n');
  }
  return ids;
}

std::vector<std::string> SlurmArray::Submit(const std::vector<std::string>& options,
                                            const std::vector<std::string>& after,
                                            std::stop_token stop) const {
  std::vector<size_t> all(size());
  std::iota(all.begin(), all.end(), size_t{0});
  std::vector<std::string> with_order = options;
  if (!after.empty()) with_order.push_back(fmt::format("--dependency=afterany:{}", fmt::join(after, ":")));
  return SubmitTasks(all, with_order, stop);
}

void SlurmArray::Wait(const std::vector<std::string>& ids, const std::vector<size_t>& tasks,
                      Progress& progress, std::stop_token stop) const {
  size_t told = 0;
  auto pause = std::chrono::milliseconds(kFirstPause);
  for (int looks = 0; looks < kLooksAfterEnd;) {
    size_t ended = 0;
    const std::vector<std::string> names = folder_.Names();  // sorted
    for (const size_t task : tasks) ended += std::ranges::binary_search(names, StatusFile(task)) ? 1 : 0;
    if (ended > told) progress.Advance(ended - told);
    told = std::max(told, ended);
    if (ended == tasks.size()) return;
    if (std::ranges::none_of(ids, [&](const std::string& id) { return IsQueued(id, stop); })) ++looks;
    Pause(pause, stop);
    pause = std::min<std::chrono::milliseconds>(2 * pause, kLongestPause);
  }
}

void SlurmArray::Run(const std::vector<std::string>& options, Progress& progress,
                     std::stop_token stop) const {
  std::vector<size_t> open(size());
  std::iota(open.begin(), open.end(), size_t{0});
  for (int attempt = 0; attempt < 2 && !open.empty(); ++attempt) {
    Wait(SubmitTasks(open, options, stop), open, progress, stop);
    std::erase_if(open, [this](size_t task) { return !Failed(task); });
    if (attempt == 0)
      for (const size_t task : open) folder_.RemoveAll(StatusFile(task));
  }
}

int SlurmArray::StatusOf(size_t task) const {
  const std::string text = ReadOr(folder_, StatusFile(task), "");
  const std::optional<double> status = ParseNumber(text.substr(0, text.find('\n')));
  return status ? static_cast<int>(*status) : 3;
}

std::string SlurmArray::ErrorsOf(size_t task) const {
  return ReadOr(folder_, fmt::format("{}.err", task), "the task left no result\n");
}

std::vector<std::string> SlurmArray::InQueue(const Folder& folder, std::stop_token stop) {
  std::vector<std::string> ids;
  const std::string submitted = ReadOr(folder, kSubmitted, "");
  for (size_t at = 0, end; (end = submitted.find('\n', at)) != std::string::npos; at = end + 1) {
    const std::string id = submitted.substr(at, end - at);
    if (IsQueued(id, stop)) ids.push_back(id);
  }
  return ids;
}

void SlurmArray::WaitForEarlier(const Folder& folder, std::stop_token stop) {
  auto pause = std::chrono::milliseconds(kFirstPause);
  while (!InQueue(folder, stop).empty()) {
    Pause(pause, stop);
    pause = std::min<std::chrono::milliseconds>(2 * pause, kLongestPause);
  }
}

}  // namespace millpose
