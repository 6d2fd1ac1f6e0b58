// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/verify_programs.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/cell_texts.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "output/output_folder.hpp"
#include "pipeline/check_program.hpp"
#include "pipeline/make_programs.hpp"
#include "pipeline/program_motions.hpp"
#include "pipeline/start_programs.hpp"
#include "program/reader.hpp"
#include "verify/causes.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> SortedFiles(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The controller whose main programs end like this file; of several the first that the cell has.
std::string ControllerOf(const fs::path& program, const CellSettings& cell) {
  std::string found;
  for (const PostEntry& entry : Posts().entries()) {
    if (program.extension() != entry.make()->Endings().front()) continue;
    if (cell.controllers.contains(entry.name)) return entry.name;
    if (found.empty()) found = entry.name;
  }
  if (!found.empty()) return found;
  std::vector<std::string> endings = MainEndings();
  const std::string last = endings.back();
  endings.pop_back();
  throw InputError(Place{program.string(), 0, 0, -1},
                   fmt::format("a folder of millpose plan, or a program ending in {} or {} expected",
                               fmt::join(endings, ", "), last));
}

/// The main file and what it calls, directly or not, in the same folder.
ProgramFiles FilesOf(const fs::path& program, const Post& post, const FileRoot& root) {
  const std::vector<std::string> endings = post.Endings();
  ProgramFiles files = {{program.filename().string(), root.Read(program)}};
  const std::vector<std::string> beside =
      SortedFiles(program.has_parent_path() ? program.parent_path() : ".");
  for (bool found = true; found;) {
    found = false;
    for (const std::string& name : beside) {
      const std::string extension = fs::path(name).extension().string();
      const bool may = std::ranges::find(endings, extension) != endings.end();
      if (!may || files.contains(name)) continue;
      const bool called = std::any_of(files.begin(), files.end(), [&](const auto& file) {
        return CallsProgram(file.second, fs::path(name).stem().string());
      });
      if (!called) continue;
      files[name] = root.Read(program.parent_path() / name);
      found = true;
    }
  }
  return files;
}

/// Frames that the program leaves to the controller, as far as its own header and the cell tell them. Returns
/// what is assumed thereby.
std::vector<std::string> AssumeFrames(MotionProgram& program, const Pose& X_KB) {
  std::vector<std::string> assumptions = {"the part is not there: clearance from it is not checked"};
  if (program.swivel && !program.frames_checked)
    assumptions.push_back("the controller's $ROBROOT is the cell's: the program does not check it");
  const auto is_pose = [](const Motion& motion) { return !motion.q; };
  if (std::ranges::none_of(program.motions, is_pose)) return assumptions;
  if (!program.X_FT) assumptions.push_back("the controller's tool is the cell's");
  if (program.X_BP) return assumptions;
  for (const auto& [key, value] : program.header) {
    if (key != "base_pose") continue;
    const std::optional<Pose> X_KP = ReadPoseText(value);
    if (X_KP) program.X_BP = X_KB.inverse() * *X_KP;
    assumptions.push_back("the controller's base is as the header's base_pose says: " + value);
  }
  if (!program.X_BP)
    throw InputError(Place{program.files.front(), 1, 0, -1},
                     "the base is a frame that the controller holds; a line 'base_pose: " +
                         PoseText(Pose::Identity()) + "' with its values expected in the header");
  return assumptions;
}

std::vector<VerifiedProgram> VerifyAlone(const VerifyArguments& arguments, const Execution& execution) {
  if (!arguments.cell) {
    throw InputError(Place{arguments.target.string(), 0, 0, -1},
                     "a program needs its cell: --cell CELL.yaml expected");
  }
  JobInputs inputs;
  inputs.cell = LoadCell(*arguments.cell, &inputs.body_bytes, arguments.root);
  const std::string controller = ControllerOf(arguments.target, inputs.cell);
  SelectTool(arguments.tool, &inputs.cell);
  const World world(MakeCell(inputs.cell, inputs.body_bytes));
  const Programming with(inputs, controller, world, execution);
  const Post& post = with.post;
  MotionProgram program =
      post.Read(FilesOf(arguments.target, post, arguments.root), world.cell().arm, with.settings);
  std::vector<std::string> assumptions = AssumeFrames(program, post.BaseInWorld(with.settings));
  for (const DeclaredCall& call : program.calls) assumptions.push_back(AssumptionOf(call));
  std::ranges::copy(post.Assumptions(with.settings), std::back_inserter(assumptions));
  std::ranges::copy(CellWarnings(inputs.cell), std::back_inserter(assumptions));
  return {{controller, arguments.target.string(), program.motions.size(),
           Verify(program, world, nullptr, with.options, with.execution), assumptions}};
}

/// The resolved job of an output folder with everything it names.
JobInputs InputsOf(const VerifyArguments& arguments) {
  std::optional<fs::path> origin;
  if (arguments.job) origin = fs::absolute(*arguments.job).parent_path();
  JobInputs inputs = LoadJobInputs(arguments.target / "job.yaml", {}, origin, arguments.root);
  TakeKeptMeshes(arguments.target, &inputs);
  return inputs;
}

/// The programs of single pieces, where the folder holds some.
void VerifyStarts(const PlanResult& plan, const VerifyArguments& arguments, const std::vector<CallWay>& calls,
                  const Programming& with, std::vector<VerifiedProgram>& programs) {
  const fs::path folder = arguments.target / "programs" / with.controller / kStarts;
  const fs::path ways_file = arguments.target / kStartWays;
  if (!fs::is_directory(folder)) return;
  const PlanResult ways = ParsePlanResult(arguments.root.Read(ways_file), ways_file.string());
  for (size_t i = 0; i + 1 < plan.gaps.size(); ++i) {
    const PlanResult single = SingleStart(plan, ways, i);
    const fs::path file = folder / (single.job + with.post.Endings().front());
    if (!fs::exists(file)) continue;  // withheld
    MotionProgram program = with.post.Read(FilesOf(file, with.post, arguments.root), plan.arm, with.settings);
    const ProgramMotions motions = MakeProgramMotions(single, with.inputs, with.controller, {}, calls);
    CompleteFrames(program, motions.planned);
    programs.push_back({with.controller, file.string(), program.motions.size(),
                        CheckProgram(program, motions, single, with).findings,
                        CellWarnings(with.inputs.cell)});
  }
}

std::vector<VerifiedProgram> VerifyFolder(const VerifyArguments& arguments, const Execution& execution) {
  CheckManifest(arguments.target);
  const fs::path plan_file = arguments.target / kPlanFile;
  const PlanResult plan = ParsePlanResult(arguments.root.Read(plan_file), plan_file.string());
  const JobInputs inputs = InputsOf(arguments);
  const World world(MakeJobCell(inputs));
  std::vector<VerifiedProgram> programs;
  std::vector<std::string> controllers = Posts().Names();
  std::ranges::sort(controllers);
  for (const std::string& controller : controllers) {
    const fs::path folder = arguments.target / "programs" / controller;
    if (!fs::is_directory(folder)) continue;
    execution.progress.Begin(controller, 0);
    ProgramFiles files;
    for (const std::string& name : SortedFiles(folder)) files[name] = arguments.root.Read(folder / name);
    Programming with(inputs, controller, world, execution);
    with.options.interference |= arguments.interference;
    MotionProgram program = with.post.Read(files, plan.arm, with.settings);
    const std::vector<CallWay> calls = PlanCallWays(world, inputs, controller, with.execution.stop);
    const ProgramMotions motions = MakeProgramMotions(plan, inputs, controller, {}, calls);
    CompleteFrames(program, motions.planned);
    VerifiedProgram verified{
        controller, folder.string(), program.motions.size(), {}, CellWarnings(inputs.cell)};
    for (const DeclaredCall& call : program.calls) verified.assumptions.push_back(AssumptionOf(call));
    std::ranges::copy(with.post.Assumptions(with.settings), std::back_inserter(verified.assumptions));
    verified.findings = CheckProgram(program, motions, plan, with).findings;
    execution.progress.End(
        fmt::format("{} motions, {} findings", verified.motions, verified.findings.size()));
    programs.push_back(std::move(verified));
    VerifyStarts(plan, arguments, calls, with, programs);
  }
  if (programs.empty())
    throw InputError(Place{arguments.target.string(), 0, 0, -1}, "the folder holds no programs");
  return programs;
}

}  // namespace

std::vector<std::string> MainEndings() {
  std::vector<std::string> endings;
  for (const PostEntry& entry : Posts().entries()) {
    const std::string ending = entry.make()->Endings().front();
    if (std::ranges::find(endings, ending) == endings.end()) endings.push_back(ending);
  }
  return endings;
}

std::vector<VerifiedProgram> VerifyPrograms(const VerifyArguments& arguments, Progress& progress,
                                            std::stop_token stop) {
  const Execution execution{arguments.threads, progress, std::move(stop)};
  return fs::is_directory(arguments.target) ? VerifyFolder(arguments, execution)
                                            : VerifyAlone(arguments, execution);
}

std::string VerifyText(const std::vector<VerifiedProgram>& programs) {
  std::string text;
  for (const VerifiedProgram& program : programs) {
    text += fmt::format("{:<10} {:>7} motions  {}  {}\n", program.controller, program.motions,
                        program.findings.empty() ? "confirmed" : "NOT confirmed", program.file);
    for (const std::string& assumption : program.assumptions) text += "  assumed: " + assumption + "\n";
    for (const CauseGroup& group : GroupByCause(program.findings)) {
      text += fmt::format("  {}; what helps: {}\n", Describe(group), Cure(group.cause, program.controller));
      for (const Finding& finding : program.findings) {
        if (finding.cause != group.cause) continue;
        text += fmt::format("  {}:{}: {}\n", finding.file, finding.line, finding.message);
      }
    }
  }
  return text;
}

std::string VerifyJson(const std::vector<VerifiedProgram>& programs) {
  nlohmann::ordered_json json = {{"schema_version", 1}, {"programs", nlohmann::ordered_json::array()}};
  for (const VerifiedProgram& program : programs) {
    nlohmann::ordered_json findings = nlohmann::ordered_json::array();
    for (const Finding& finding : program.findings) {
      findings.push_back({{"file", finding.file}, {"line", finding.line}, {"message", finding.message}});
    }
    json["programs"].push_back({{"controller", program.controller},
                                {"file", program.file},
                                {"motions", program.motions},
                                {"confirmed", program.findings.empty()},
                                {"findings", findings},
                                {"assumptions", program.assumptions}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
