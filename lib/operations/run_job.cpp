// SPDX-License-Identifier: GPL-3.0-or-later
#include "operations/run_job.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/named_progress.hpp"
#include "job/step_meshes.hpp"
#include "operations/whole_report.hpp"
#include "output/output_folder.hpp"
#include "pipeline/run_record.hpp"
#include "pipeline/up_to_date.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

/// Folders of operations that the job has no more.
void RemoveOthers(const fs::path& out, const std::vector<std::string>& folders) {
  for (const std::string& folder : OperationFolders(out))
    if (std::ranges::find(folders, folder) == folders.end()) RemoveAll(out / folder);
}

void AddResults(const std::string& name, const std::vector<DoneOperation>& operations,
                const std::vector<WholeProgram>& programs, ResultSet& results) {
  results.Add("points.csv", WholePoints(operations));
  results.Add("summary.json", WholeSummary(name, operations, programs));
  results.Add("report.html", WholeReport(name, operations, programs));
  for (const WholeProgram& program : programs) {
    if (!program.withheld.empty() || !program.findings.empty()) continue;
    for (const auto& [file, text] : program.files)
      results.Add(fmt::format("{}/{}/{}", kProgramsFolder, program.controller, file), text);
  }
}

PlanOutcome RunOperations(const PlanArguments& arguments, const JobOutline& outline, Progress& progress,
                          const std::stop_token& stop) {
  Stages stages(progress);
  const std::vector<JobInputs> inputs = LoadOperations(arguments.job, OverridesOf(arguments), arguments.root);
  const fs::path out = arguments.out.value_or(DefaultFolder(arguments.job, outline.name));
  if (!arguments.out) arguments.root.CheckFolder(out);
  const OutputFolder folder(out, arguments.share ? FolderUse::kCheckpoints : FolderUse::kResults);
  const RunFigures begun = BeginRun(arguments, outline.name, inputs.front().folder, folder);
  std::vector<std::string> folders;
  std::string shares;
  int status = 0;
  for (size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i].job.operation;
    folders.push_back(fmt::format("{}/{}", kOperationsFolder, OperationFolder(i, name)));
    PlanArguments own = arguments;
    own.operation = i;
    own.out = out / folders.back();
    MakeFolders(own.out->parent_path());
    NamedProgress told(stages, name);
    const PlanOutcome outcome = RunPlan(own, told, stop);
    status = std::max(status, outcome.exit_status);
    if (arguments.share) shares += fmt::format("operation {}: {}", name, outcome.text);
  }
  if (arguments.share) return {0, shares};
  RemoveOthers(out, folders);

  stages.Begin("main programs", 0);
  std::vector<DoneOperation> operations;
  for (const std::string& own : folders) operations.push_back(ReadOperation(out, own, arguments.root));
  std::vector<WholeProgram> programs;
  for (const std::string& controller : inputs.front().job.programs) {
    programs.push_back(MakeWholeProgram(outline.name, controller, operations));
    if (!programs.back().withheld.empty() || !programs.back().findings.empty()) status = 1;
  }
  ResultSet results(folder);
  results.Add("job.yaml",
              WithOverrides(inputs.front().job_text, arguments.job.string(), OverridesOf(arguments)));
  AddResults(outline.name, operations, programs, results);
  stages.End(fmt::format("{} of {} controllers",
                         std::ranges::count_if(programs,
                                               [](const WholeProgram& program) {
                                                 return program.withheld.empty() && program.findings.empty();
                                               }),
                         programs.size()));
  RunFigures run = EndRun(begun, stages, Execution{arguments.threads, stages, stop}.Threads());
  run.manifest = results.AddManifest(KeyOf(inputs, out));
  run.exit_status = status;
  run.told = WholeText(operations, programs, out);
  results.Add(kRunFile, RunJson(run));
  results.Publish();
  return {status, run.told + (folder.warning().empty() ? "" : "warning    " + folder.warning() + '\n')};
}

}  // namespace

std::string OperationFolder(size_t number, const std::string& name) {
  return fmt::format("{:02}_{}", number + 1, name);
}

std::vector<JobInputs> LoadOperations(const fs::path& job, const std::vector<Override>& overrides,
                                      const FileRoot& root) {
  const size_t count = OutlineOf(root.Read(job), job.string(), overrides).operations.size();
  if (count == 0) return {LoadJobInputs(job, overrides, {}, root)};
  std::vector<JobInputs> inputs;
  std::vector<Problem> problems;
  for (size_t i = 0; i < count; ++i) {
    try {
      inputs.push_back(LoadJobInputs(job, overrides, {}, root, i));
      CheckPrograms(inputs.back());
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems())
        if (std::ranges::none_of(problems, [&](const Problem& known) {
              return known.message == problem.message && known.place.file == problem.place.file &&
                     known.place.line == problem.place.line;
            }))
          problems.push_back(problem);
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return inputs;
}

std::string KeyOf(std::vector<JobInputs> inputs, const fs::path& folder) {
  if (inputs.size() == 1 && !inputs.front().operation) {
    TakeKeptMeshes(folder, &inputs.front());
    return inputs.front().hash;
  }
  std::string all;
  for (size_t i = 0; i < inputs.size(); ++i) {
    TakeKeptMeshes(folder / kOperationsFolder / OperationFolder(i, inputs[i].job.operation), &inputs[i]);
    all += inputs[i].hash + '\0';
  }
  return Hash(all);
}

PlanOutcome RunJob(const PlanArguments& arguments, Progress& progress, std::stop_token stop) {
  RecoverOutputFolder(
      FolderOf(arguments.job));  // the job may be the resolved one of a folder that a killed run left
  const JobOutline outline =
      OutlineOf(arguments.root.Read(arguments.job), arguments.job.string(), OverridesOf(arguments));
  if (outline.operations.empty()) return RunPlan(arguments, progress, std::move(stop));
  return RunOperations(arguments, outline, progress, stop);
}

}  // namespace millpose
