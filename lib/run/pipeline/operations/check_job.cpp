// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/check_job.hpp"

#include <map>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/loose_file.hpp"
#include "job/split_sections.hpp"
#include "run/pipeline/operations/run_job.hpp"
#include "run/pipeline/operations/stock_handed_on.hpp"

namespace millpose {

std::vector<JobCheck> CheckOperations(const std::filesystem::path& job, const CheckJobArguments& arguments,
                                      const FileRoot& root, Progress& progress, const std::stop_token& stop) {
  std::vector<JobInputs> inputs = LoadOperations(job, arguments.overrides, root);
  std::vector<JobCheck> checks;
  StockHandedOn handed;
  for (size_t i = 0; i < inputs.size(); ++i) {
    CheckJobArguments own = arguments;
    if (own.view && inputs[i].operation) own.view->file = ViewOf(own.view->file, i, inputs[i].job.operation);
    inputs[i].cut_before = handed.Before(inputs[i]);
    checks.push_back(CheckJob(std::move(inputs[i]), own, progress, stop));
    handed.Add(checks.back().cuts);
  }
  return checks;
}

namespace {

/// A job that is to be split names none of several tools: the first stands for all until then.
std::vector<Override> AnyTool(const std::filesystem::path& job, const std::string& text,
                              const FileRoot& root) {
  const JobSettings settings = ParseJob(text, job.string());
  if (!settings.tool.empty()) return {};
  std::map<std::string, std::string> ignored;
  const CellSettings cell = LoadCell(job.parent_path() / settings.cell_file, &ignored, root);
  if (cell.tools.empty()) return {};
  return {{"tool", cell.tools.front().name}};
}

}  // namespace

std::vector<std::string> WriteSplitJob(const std::filesystem::path& job, const std::filesystem::path& to,
                                       const FileRoot& root) {
  namespace fs = std::filesystem;
  if (fs::weakly_canonical(fs::absolute(to)).parent_path() !=
      fs::weakly_canonical(fs::absolute(job)).parent_path())
    throw InputError(
        SourceLocation{},
        fmt::format("--split: given {}; allowed: a file beside {}, since its paths count from there",
                    to.string(), job.string()));
  if (Exists(to))
    throw InputError(SourceLocation{},
                     fmt::format("--split: {} exists already; allowed: a name that is free", to.string()));
  const std::string text = root.Read(job);
  if (!OutlineOf(text, job.string()).operations.empty())
    throw InputError({job.string()},
                     "operations: the job has them already; --split makes them of a CAM file");
  const std::string split = SplitIntoOperations(text, LoadJobInputs(job, AnyTool(job, text, root), {}, root));
  std::vector<std::string> names = OutlineOf(split, to.string()).operations;
  WriteLooseFile(to, split);
  return names;
}

std::filesystem::path ViewOf(const std::filesystem::path& view, size_t number, const std::string& name) {
  return view.parent_path() / fmt::format("{}_{}{}", view.stem().string(), OperationFolder(number, name),
                                          view.extension().string());
}

}  // namespace millpose
