// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/run_job.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/named_progress.hpp"
#include "job/assemble.hpp"
#include "job/config/setup_names.hpp"
#include "job/step_meshes.hpp"
#include "planning/standing/leave_in_stock.hpp"
#include "run/pipeline/operations/stock_handed_on.hpp"
#include "run/pipeline/operations/whole_report.hpp"
#include "run/pipeline/outputs/run_record.hpp"
#include "run/pipeline/outputs/up_to_date.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

bool IsWritten(const WholeProgram& program) { return program.withheld.empty() && program.findings.empty(); }

void AddResults(const std::string& name, const std::vector<DoneOperation>& operations,
                const std::vector<WholeProgram>& programs, Language language, ResultSet& results) {
  results.Add("points.csv", WholePoints(operations));
  results.Add("summary.json", WholeSummary(name, operations, programs));
  results.Add("report.html", WholeReport(name, operations, programs, language));
  for (const WholeProgram& program : programs) {
    if (!IsWritten(program)) continue;
    for (const auto& [file, text] : program.files)
      results.Add(fmt::format("{}/{}/{}", kProgramsFolder, program.controller, file), text);
  }
}

bool AnyHasStock(const std::vector<JobInputs>& inputs) {
  return std::ranges::any_of(inputs, [](const JobInputs& own) { return own.job.workpiece.HasStock(); });
}

PlanResult StagedPlan(const ResultSet& results, const std::string& operation, const FileRoot& root) {
  return ReadPlanIn(results.staged() / kOperationsFolder / operation, root);
}

/// Each planned into `whole`, which is null where only a share is.
PlanOutcome PlanEach(const PlanArguments& arguments, const std::vector<JobInputs>& inputs,
                     const OutputFolder& folder, ResultSet* whole, Stages& stages,
                     const std::stop_token& stop) {
  PlanOutcome all;
  StockHandedOn handed;
  std::string before;
  for (size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i].job.operation;
    PlanArguments own = arguments;
    own.operation = i;
    own.cut_before = handed.Before(inputs[i]);
    if (whole && inputs[i].job.workpiece.HasStock()) own.before = before;
    NamedProgress told(stages, name);
    const PlanOutcome outcome =
        PlanOperation(own, folder.Operation(OperationFolder(i, name)), whole, told, stop);
    all.exit_status = std::max(all.exit_status, outcome.exit_status);
    if (arguments.share) all.text += fmt::format("operation {}: {}", name, outcome.text);
    if (!whole || !AnyHasStock(inputs)) continue;
    before += inputs[i].hash + '\0';
    handed.Add(CutsOf(StagedPlan(*whole, OperationFolder(i, name), arguments.root),
                      MakeCutterShape(inputs[i].cell.tool)));
  }
  return all;
}

/// The operations as they are staged, in their order.
std::vector<DoneOperation> Staged(const std::vector<JobInputs>& inputs, const ResultSet& results,
                                  const PlanArguments& arguments) {
  const std::vector<std::string> setups =
      SetupNames(inputs.front().job_text, arguments.job.string(), OverridesOf(arguments));
  std::vector<DoneOperation> operations;
  for (size_t i = 0; i < inputs.size(); ++i) {
    operations.push_back(
        ReadOperation(results.staged(),
                      fmt::format("{}/{}", kOperationsFolder, OperationFolder(i, inputs[i].job.operation)),
                      arguments.root));
    operations.back().setup = setups[i];
  }
  return operations;
}

std::vector<WholeProgram> MainPrograms(const JobInputs& job, const std::string& name,
                                       const std::vector<DoneOperation>& operations) {
  std::vector<WholeProgram> programs;
  for (const std::string& controller : job.job.programs)
    for (const MainProgram& main : MainProgramsOf(name, operations))
      programs.push_back(MakeWholeProgram(main, controller));
  return programs;
}

PlanOutcome PlanWhole(const PlanArguments& arguments, const std::string& name,
                      const std::vector<JobInputs>& inputs, const OutputFolder& folder,
                      const RunFigures& begun, Stages& stages, const std::stop_token& stop) {
  ResultSet results(folder, kPlanNames);
  PlanOutcome outcome = PlanEach(arguments, inputs, folder, &results, stages, stop);
  stages.Begin("main programs", 0);
  const std::vector<DoneOperation> operations = Staged(inputs, results, arguments);
  const std::vector<WholeProgram> programs = MainPrograms(inputs.front(), name, operations);
  if (!std::ranges::all_of(programs, IsWritten)) outcome.exit_status = 1;
  results.Add("job.yaml",
              WithOverrides(inputs.front().job_text, arguments.job.string(), OverridesOf(arguments)));
  AddResults(name, operations, programs, arguments.language, results);
  stages.End(fmt::format("{} of {} written", std::ranges::count_if(programs, IsWritten), programs.size()));
  RunFigures run = EndRun(begun, stages, Execution{arguments.threads, stages, stop}.Threads());
  run.manifest = results.AddManifest(KeyOf(inputs, results.staged()));
  run.exit_status = outcome.exit_status;
  run.told = WholeBrief(name, operations, programs, folder.path());
  run.details = WholeText(operations, programs, folder.path());
  results.AddRun(RunJson(run));
  results.Publish();
  std::vector<std::string> folders;
  for (const DoneOperation& done : operations) folders.push_back(fs::path(done.folder).filename().string());
  folder.KeepOperations(folders);
  return {outcome.exit_status, arguments.verbose ? run.details : run.told};
}

PlanOutcome RunOperations(const PlanArguments& arguments, const JobOutline& outline, Progress& progress,
                          const std::stop_token& stop) {
  Stages stages(progress);
  const std::vector<JobInputs> inputs = LoadOperations(arguments.job, OverridesOf(arguments), arguments.root);
  const fs::path out = arguments.out.value_or(DefaultFolder(arguments.job, outline.name));
  if (!arguments.out) arguments.root.CheckFolder(out);
  const OutputFolder folder(out, arguments.share ? FolderUse::kCheckpoints : FolderUse::kResults);
  const RunFigures begun = BeginRun(arguments, outline.name, inputs.front().folder, folder);
  if (arguments.fresh && !arguments.share) folder.RemoveCheckpoints();
  PlanOutcome outcome;
  if (arguments.share) {
    outcome.text = PlanEach(arguments, inputs, folder, nullptr, stages, stop).text;
  } else if (const auto standing =
                 arguments.fresh ? std::nullopt : FindExistingPlan(out, KeyOf(inputs, out), begun)) {
    outcome = {standing->exit_status, standing->Told(arguments.verbose) + kUnchanged};
  } else {
    outcome = PlanWhole(arguments, outline.name, inputs, folder, begun, stages, stop);
  }
  outcome.text += WarningLines(folder);
  return outcome;
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
    TakeCachedMeshes(folder, &inputs.front());
    return inputs.front().hash;
  }
  std::string all;
  for (size_t i = 0; i < inputs.size(); ++i) {
    TakeCachedMeshes(folder / kOperationsFolder / OperationFolder(i, inputs[i].job.operation), &inputs[i]);
    all += inputs[i].hash + '\0';
  }
  return Hash(all);
}

PlanOutcome RunJob(const PlanArguments& arguments, Progress& progress, std::stop_token stop) {
  // The job may be the resolved one of a folder that a killed run left between two plans.
  FinishSwap(FolderOf(arguments.job), arguments.root);
  const JobOutline outline =
      OutlineOf(arguments.root.Read(arguments.job), arguments.job.string(), OverridesOf(arguments));
  if (outline.operations.empty()) return RunPlan(arguments, progress, std::move(stop));
  return RunOperations(arguments, outline, progress, stop);
}

}  // namespace millpose
