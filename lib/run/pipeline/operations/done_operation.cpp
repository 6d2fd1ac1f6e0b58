// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/done_operation.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/setup_names.hpp"
#include "report/summary_version.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;

DoneOperation ReadOperation(const fs::path& out, const std::string& folder, const FileRoot& root,
                            std::vector<std::string>* changed) {
  const fs::path own = out / folder;
  DoneOperation done;
  done.folder = folder;
  const Manifest manifest = CheckManifest(own, changed);
  const fs::path job_file = own / "job.yaml", summary_file = own / "summary.json";
  const JobSettings job = ParseJob(root.Read(job_file), job_file.string());
  CellSettings cell = ParseCell(root.Read(own / "cell.yaml"), (own / "cell.yaml").string());
  SelectTool(job.tool, &cell);
  done.name = job.operation;
  done.job = job.name;
  done.tool = cell.tool.name;
  done.summary = root.Read(summary_file);
  CheckSummaryVersion(done.summary, summary_file.string());
  done.points = root.Read(own / "points.csv");
  for (const std::string& controller : job.programs) {
    const std::string place = fmt::format("{}/{}/", kProgramsFolder, controller);
    for (const auto& [name, file] : manifest.files)
      if (name.starts_with(place) && name.find('/', place.size()) == std::string::npos)
        done.programs[controller][name.substr(place.size())] = root.Read(own / name);
  }
  return done;
}

std::vector<DoneOperation> ReadOperations(const fs::path& out, const FileRoot& root,
                                          std::vector<std::string>* changed) {
  const fs::path job_file = out / "job.yaml";
  const std::vector<std::string> setups = SetupNames(root.Read(job_file), job_file.string());
  std::vector<DoneOperation> operations;
  for (const std::string& folder : OperationFolders(out)) {
    operations.push_back(ReadOperation(out, folder, root, changed));
    if (operations.size() <= setups.size()) operations.back().setup = setups[operations.size() - 1];
  }
  return operations;
}

std::vector<std::string> OperationFolders(const fs::path& out) {
  std::vector<std::string> folders;
  if (!Exists(out / kOperationsFolder)) return folders;
  for (const fs::path& entry : EntriesOf(out / kOperationsFolder))
    folders.push_back(fmt::format("{}/{}", kOperationsFolder, entry.filename().string()));
  std::ranges::sort(folders);
  return folders;
}

}  // namespace millpose
