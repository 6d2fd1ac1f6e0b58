// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/planned_folder.hpp"

#include <nlohmann/json.hpp>
#include <ranges>
#include <set>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "job/assemble.hpp"
#include "job/cell_texts.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "program/post_entry.hpp"
#include "run/pipeline/programs/check_program.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "run/pipeline/programs/program_files.hpp"
#include "run/pipeline/programs/start_programs.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// The resolved job of an output folder with everything it names.
JobInputs InputsOf(const fs::path& folder, const VerifyArguments& arguments) {
  std::optional<fs::path> origin;
  if (arguments.job) origin = fs::absolute(*arguments.job).parent_path();
  JobInputs inputs = LoadJobInputs(folder / "job.yaml", {}, origin, arguments.root);
  TakeCachedMeshes(folder, &inputs);
  return inputs;
}

/// Where the controller holds base or tool, lines of the header say what they must be: no mere comments.
std::vector<Finding> FrameLines(const MotionProgram& program, const MotionProgram& written) {
  std::vector<Finding> findings;
  std::vector<std::string> keys;
  if (!program.X_BP) keys = {"base", "base_pose"};
  if (!program.X_FT) keys.insert(keys.end(), {"tool", "tool_pose"});
  for (const std::string& key : keys) {
    const std::string given = HeaderValue(program, key), wanted = HeaderValue(written, key);
    if (given == wanted) continue;
    findings.push_back(
        {program.files.front(), 1,
         fmt::format("the header's line {} says \"{}\", as written: \"{}\"", key, given, wanted),
         Cause::kOther});
  }
  return findings;
}

}  // namespace

PlannedFolder::PlannedFolder(fs::path folder, Manifest manifest, const VerifyArguments& arguments,
                             Execution execution)
    : folder_(std::move(folder)),
      manifest_(std::move(manifest)),
      arguments_(arguments),
      execution_(std::move(execution)) {
  const fs::path ways_file = folder_ / kStartWays;
  plan_ = ReadPlanIn(folder_, arguments.root);
  if (fs::exists(ways_file)) ways_ = ParsePlanResult(arguments.root.Read(ways_file), ways_file.string());
  inputs_ = InputsOf(folder_, arguments);
  world_ = std::make_unique<World>(MakeJobCell(inputs_));
}

std::vector<std::string> PlannedFolder::Controllers() const {
  std::vector<std::string> controllers;
  for (const std::string& controller : Posts().Names())
    if (fs::is_directory(folder_ / kProgramsFolder / controller)) controllers.push_back(controller);
  std::ranges::sort(controllers);
  return controllers;
}

Programming PlannedFolder::With(const std::string& controller) const {
  if (!inputs_.cell.controllers.contains(controller))
    throw InputError(SourceLocation{folder_.string(), 0, 0, -1},
                     fmt::format("the plan's cell has no controller {}; it has: {}", controller,
                                 fmt::join(std::views::keys(inputs_.cell.controllers), ", ")));
  Programming with(inputs_, controller, *world_, execution_);
  with.options.interference |= arguments_.interference;
  return with;
}

const std::vector<CallTransition>& PlannedFolder::Calls(const std::string& controller) const {
  const auto known = calls_.find(controller);
  if (known != calls_.end()) return known->second;
  return calls_.emplace(controller, PlanCallTransitions(*world_, inputs_, controller, execution_.stop))
      .first->second;
}

PlannedProgram PlannedFolder::Made(PlanResult plan, const std::string& controller) const {
  ProgramMotions motions = MakeProgramMotions(plan, inputs_, controller, {}, Calls(controller));
  return {std::move(plan), std::move(motions)};
}

std::optional<PlanResult> PlannedFolder::StartOf(const std::string& name) const {
  for (size_t i = 0; ways_ && i + 1 < plan_.gaps.size(); ++i) {
    PlanResult single = SingleStart(plan_, *ways_, i);
    if (single.job == name && WhyNotProgrammable(single).empty()) return single;
  }
  return std::nullopt;
}

/// Those of the files that no program of the controller had under their name when it was written.
std::vector<std::string> PlannedFolder::Changed(const std::string& controller,
                                                const ProgramFiles& files) const {
  const std::string place = fmt::format("{}/{}/", kProgramsFolder, controller);
  std::vector<std::string> changed;
  for (const auto& [name, text] : files) {
    const std::string hash = Hash(text);
    const bool written = std::ranges::any_of(manifest_.files, [&](const auto& entry) {
      return entry.first.starts_with(place) && fs::path(entry.first).filename() == name &&
             entry.second.hash == hash && entry.second.bytes == text.size();
    });
    if (!written) changed.push_back(name);
  }
  return changed;
}

VerifiedProgram PlannedFolder::HoldTo(const PlannedProgram& planned, const ProgramFiles& files,
                                      const std::string& where, bool complete, Programming with) const {
  const Arm& arm = planned.plan.arm;
  MotionProgram program = with.post.Read(files, arm, with.settings);
  const ProgramFiles as_written = with.post.Write(planned.motions.written, arm, with.settings);
  MotionProgram written = with.post.Read(as_written, arm, with.settings);
  std::vector<Finding> frames = FrameLines(program, written);
  CompleteFrames(program, planned.motions.planned);
  CompleteFrames(written, planned.motions.planned);
  with.options.written = &written;
  VerifiedProgram verified{with.controller, where, program.motions.size(), {}, CellWarnings(inputs_.cell)};
  for (const DeclaredCall& call : program.calls) verified.assumptions.push_back(AssumptionOf(call));
  std::ranges::copy(with.post.Assumptions(with.settings), std::back_inserter(verified.assumptions));
  ProgramCheck check = CheckProgram(program, planned.motions, planned.plan, with);
  verified.findings = std::move(check.findings);
  verified.but_for = check.but_for;
  verified.changed = Changed(with.controller, files);
  std::set<std::string> read(program.files.begin(), program.files.end());
  read.insert(written.files.begin(), written.files.end());
  std::ranges::move(frames, std::back_inserter(verified.findings));
  CompareBeside(files, as_written, read, complete, verified.findings);
  return verified;
}

VerifiedProgram PlannedFolder::Hold(const std::string& controller, const std::string& name,
                                    const ProgramFiles& files, const std::string& where) const {
  return HoldTo(Made(StartOf(name).value_or(plan_), controller), files, where, false, With(controller));
}

VerifiedProgram PlannedFolder::Hold(const fs::path& program) const {
  const std::string controller = ControllerOf(program, inputs_.cell);
  const Post& post = *inputs_.cell.controllers.at(controller).post;
  return Hold(controller, program.stem().string(), FilesOf(program, post, arguments_.root), program.string());
}

ProgramFiles PlannedFolder::FilesIn(const fs::path& folder) const {
  ProgramFiles files;
  for (const std::string& name : SortedFiles(folder)) files[name] = arguments_.root.Read(folder / name);
  return files;
}

void PlannedFolder::HoldStarts(const Programming& with, std::vector<VerifiedProgram>& programs) const {
  const fs::path folder = folder_ / kProgramsFolder / with.controller / kStarts;
  if (!fs::is_directory(folder) || !ways_) return;
  for (size_t i = 0; i + 1 < plan_.gaps.size(); ++i) {
    PlanResult single = SingleStart(plan_, *ways_, i);
    const fs::path file = folder / (single.job + with.post.Endings().front());
    if (!fs::exists(file)) continue;  // withheld
    programs.push_back(HoldTo(Made(std::move(single), with.controller),
                              FilesOf(file, with.post, arguments_.root), file.string(), true, with));
  }
}

/// Programs that the plan's summary calls confirmed are there.
void PlannedFolder::MissLost(std::vector<VerifiedProgram>& programs) const {
  const fs::path file = folder_ / "summary.json";
  const nlohmann::json summary = nlohmann::json::parse(arguments_.root.Read(file), nullptr, false);
  if (!summary.is_object()) throw InputError({file.string()}, "is no summary");
  std::set<std::string> lost;
  for (const nlohmann::json& program : summary.value("programs", nlohmann::json::array()))
    if (program.value("verified", false)) lost.insert(program.value("controller", ""));
  for (const std::string& controller : Controllers()) lost.erase(controller);
  for (const std::string& controller : lost) {
    const std::string place = (folder_ / kProgramsFolder / controller).string();
    programs.push_back({controller, place, 0, {{place, 0, "is missing", Cause::kText}}, {}});
  }
}

std::vector<VerifiedProgram> PlannedFolder::HoldAll() const {
  std::vector<VerifiedProgram> programs;
  for (const std::string& controller : Controllers()) {
    execution_.progress.Begin(controller, 0);
    const Programming with = With(controller);
    const fs::path folder = folder_ / kProgramsFolder / controller;
    programs.push_back(HoldTo(Made(plan_, controller), FilesIn(folder), folder.string(), true, with));
    execution_.progress.End(
        fmt::format("{} motions, {} findings", programs.back().motions, programs.back().findings.size()));
    HoldStarts(with, programs);
  }
  MissLost(programs);
  return programs;
}

}  // namespace millpose
