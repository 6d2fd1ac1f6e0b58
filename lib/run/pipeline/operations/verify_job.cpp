// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/verify_job.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "job/config/config.hpp"
#include "program/calling_program.hpp"
#include "run/pipeline/operations/whole_program.hpp"
#include "run/pipeline/programs/planned_folder.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// A job of several operations as its folder holds it, to verify its main programs and what they call.
class WholeFolder {
 public:
  WholeFolder(fs::path folder, const VerifyArguments& arguments, Execution execution)
      : folder_(std::move(folder)), arguments_(arguments), execution_(std::move(execution)) {
    const fs::path job_file = folder_ / "job.yaml";
    job_ = OutlineOf(arguments.root.Read(job_file), job_file.string()).name;
    std::vector<std::string> changed;  // each program is held against its plan
    operations_ = ReadOperations(folder_, arguments.root, &changed);
    mains_ = MainProgramsOf(job_, operations_);
  }

  /// The main programs: one of each controller and setup that all operations have a program for.
  std::vector<VerifiedProgram> Mains(const Manifest& manifest) const {
    std::vector<VerifiedProgram> programs;
    for (const auto& [controller, own] : operations_.front().programs)
      for (const MainProgram& main : mains_)
        if (HasAll(main, controller)) programs.push_back(VerifiedMain(main, controller, manifest));
    return programs;
  }

  /// A main program, or the program of an operation by itself, wherever it is.
  std::vector<VerifiedProgram> Hold(const fs::path& program) const {
    const std::string controller = ControllerOf(program, CellOf(operations_.front()));
    const auto post = MakePost(controller);
    const CallingSyntax syntax = post->Calling();
    ProgramFiles files = FilesOf(program, *post, arguments_.root);
    std::string& text = files.at(program.filename().string());
    const std::vector<std::string> calls = CallsOf(syntax, program.stem().string(), text);
    for (const std::string& name : calls)
      if (const fs::path file = program.parent_path() / (name + syntax.called_ending); fs::exists(file))
        files.merge(FilesOf(file, *post, arguments_.root));
    if (!calls.empty())
      return {{controller, program.string(), 0, Check(MainOfFile(syntax, program), controller, files), {}}};
    for (const DoneOperation& operation : operations_) {
      const auto own = operation.programs.find(controller);
      if (own == operation.programs.end()) continue;
      const CalledProgram called = AsCalled(syntax, operation.job, own->second);
      const std::string name = program.filename().string();
      if (!called.files.contains(name) && !own->second.contains(name)) continue;
      text = AsStandingAlone(syntax, called.name, text);
      return {PlanOf(operation).Hold(controller, program.stem().string(), files, program.string())};
    }
    throw InputError({program.string()},
                     fmt::format("no operation of {} has a program of this name", folder_.string()));
  }

 private:
  CellSettings CellOf(const DoneOperation& operation) const {
    const fs::path file = folder_ / operation.folder / "cell.yaml";
    return ParseCell(arguments_.root.Read(file), file.string());
  }

  static bool HasAll(const MainProgram& main, const std::string& controller) {
    return std::ranges::all_of(main.operations, [&](const DoneOperation& operation) {
      return operation.programs.contains(controller);
    });
  }

  /// The controller's folder without what the main programs of other setups have there.
  ProgramFiles FilesBeside(const MainProgram& main, const std::string& controller) const {
    const fs::path place = folder_ / kProgramsFolder / controller;
    ProgramFiles files;
    if (fs::is_directory(place))
      for (const std::string& name : SortedFiles(place)) files[name] = arguments_.root.Read(place / name);
    for (const MainProgram& other : mains_)
      if (other.name != main.name && HasAll(other, controller))
        for (const std::string& name : FilesOfMain(other, controller)) files.erase(name);
    return files;
  }

  VerifiedProgram VerifiedMain(const MainProgram& main, const std::string& controller,
                               const Manifest& manifest) const {
    const ProgramFiles files = FilesBeside(main, controller);
    VerifiedProgram verified{controller, (folder_ / kProgramsFolder / controller).string(), 0, {}, {}};
    for (const auto& [name, text] : files) {
      const auto entry = manifest.files.find(fmt::format("{}/{}/{}", kProgramsFolder, controller, name));
      if (entry == manifest.files.end() || entry->second.hash != Hash(text)) verified.changed.push_back(name);
    }
    verified.findings = Check(main, controller, files);
    return verified;
  }

  /// Which main program a file should be; the first where its name is that of none.
  const MainProgram& MainOfFile(const CallingSyntax& syntax, const fs::path& file) const {
    const auto found = std::ranges::find_if(mains_, [&](const MainProgram& main) {
      return ProgramName(syntax, main.name) + syntax.ending == file.filename().string();
    });
    return found == mains_.end() ? mains_.front() : *found;
  }

  PlannedFolder PlanOf(const DoneOperation& operation) const {
    const fs::path folder = folder_ / operation.folder;
    std::vector<std::string> changed;
    return {folder, CheckManifest(folder, &changed), arguments_, execution_};
  }

  std::vector<Finding> Check(const MainProgram& main, const std::string& controller,
                             const ProgramFiles& files) const {
    const CallingSyntax syntax = MakePost(controller)->Calling();
    return CheckWholeProgram(
        main, controller, files, [&](const DoneOperation& operation, ProgramFiles called) {
          const std::string name = AsCalled(syntax, operation.job, operation.programs.at(controller)).name;
          std::string& text = called.at(name + syntax.called_ending);
          text = AsStandingAlone(syntax, name, text);
          return PlanOf(operation).Hold(controller, name, called, "").findings;
        });
  }

  const fs::path folder_;
  const VerifyArguments& arguments_;
  const Execution execution_;
  std::string job_;
  std::vector<DoneOperation> operations_;
  std::vector<MainProgram> mains_;
};

std::vector<VerifiedProgram> VerifySeveral(const VerifyArguments& arguments, Progress& progress,
                                           const std::stop_token& stop) {
  std::vector<std::string> changed;
  const Manifest manifest = CheckManifest(arguments.target, &changed);
  std::vector<VerifiedProgram> programs;
  for (const std::string& folder : OperationFolders(arguments.target)) {
    VerifyArguments own = arguments;
    own.target = arguments.target / folder;
    std::ranges::copy(VerifyPrograms(own, progress, stop), std::back_inserter(programs));
  }
  std::ranges::copy(
      WholeFolder(arguments.target, arguments, {arguments.threads, progress, stop}).Mains(manifest),
      std::back_inserter(programs));
  return programs;
}

std::vector<VerifiedProgram> HoldOne(const VerifyArguments& arguments, const Execution& execution) {
  std::vector<std::string> changed;
  CheckManifest(*arguments.plan, &changed);
  return WholeFolder(*arguments.plan, arguments, execution).Hold(arguments.target);
}

}  // namespace

std::vector<VerifiedProgram> VerifyJob(const VerifyArguments& arguments, Progress& progress,
                                       std::stop_token stop) {
  const bool folder = fs::is_directory(arguments.target);
  if (!folder && !arguments.plan) return VerifyPrograms(arguments, progress, std::move(stop));
  const fs::path planned = folder ? arguments.target : *arguments.plan;
  arguments.root.CheckFolder(planned);
  std::vector<VerifiedProgram> programs;
  ReadWhole(planned, [&] {
    if (!HoldsSeveral(planned))
      programs = VerifyPrograms(arguments, progress, stop);
    else if (folder)
      programs = VerifySeveral(arguments, progress, stop);
    else
      programs = HoldOne(arguments, {arguments.threads, progress, stop});
  });
  return programs;
}

}  // namespace millpose
