// SPDX-License-Identifier: GPL-3.0-or-later
#include "operations/verify_job.hpp"

#include "base/file.hpp"
#include "config/config.hpp"
#include "operations/whole_program.hpp"
#include "output/output_folder.hpp"
#include "output/read_whole.hpp"

namespace millpose {
namespace fs = std::filesystem;

namespace {

std::vector<VerifiedProgram> VerifySeveral(const VerifyArguments& arguments, Progress& progress,
                                           const std::stop_token& stop) {
  const Manifest manifest = CheckManifest(arguments.target);
  const fs::path job_file = arguments.target / "job.yaml";
  const std::string job = OutlineOf(arguments.root.Read(job_file), job_file.string()).name;
  std::vector<DoneOperation> operations;
  std::vector<VerifiedProgram> programs;
  for (const std::string& folder : OperationFolders(arguments.target)) {
    VerifyArguments own = arguments;
    own.target = arguments.target / folder;
    std::ranges::copy(VerifyPrograms(own, progress, stop), std::back_inserter(programs));
    operations.push_back(ReadOperation(arguments.target, folder, arguments.root));
  }
  std::map<std::string, ProgramFiles> mains;
  for (const auto& [name, file] : manifest.files) {
    const fs::path path(name);
    if (path.parent_path().parent_path() == kProgramsFolder)
      mains[path.parent_path().filename().string()][path.filename().string()] =
          arguments.root.Read(arguments.target / name);
  }
  for (const auto& [controller, files] : mains)
    programs.push_back({controller,
                        (arguments.target / kProgramsFolder / controller).string(),
                        0,
                        CheckWholeProgram(job, controller, operations, files),
                        {}});
  return programs;
}

}  // namespace

std::vector<VerifiedProgram> VerifyJob(const VerifyArguments& arguments, Progress& progress,
                                       std::stop_token stop) {
  if (!fs::is_directory(arguments.target)) return VerifyPrograms(arguments, progress, std::move(stop));
  arguments.root.CheckFolder(arguments.target);
  std::vector<VerifiedProgram> programs;
  ReadWhole(arguments.target, [&] {
    programs = HoldsSeveral(arguments.target) ? VerifySeveral(arguments, progress, stop)
                                              : VerifyPrograms(arguments, progress, stop);
  });
  return programs;
}

}  // namespace millpose
