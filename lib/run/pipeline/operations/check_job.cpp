// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/check_job.hpp"

#include "run/pipeline/operations/run_job.hpp"

namespace millpose {

std::vector<JobCheck> CheckOperations(const std::filesystem::path& job, const CheckJobArguments& arguments,
                                      const FileRoot& root, Progress& progress, const std::stop_token& stop) {
  std::vector<JobInputs> inputs = LoadOperations(job, {}, root);
  std::vector<JobCheck> checks;
  for (size_t i = 0; i < inputs.size(); ++i) {
    CheckJobArguments own = arguments;
    if (own.view && inputs[i].operation) own.view = ViewOf(*own.view, i, inputs[i].job.operation);
    checks.push_back(CheckJob(std::move(inputs[i]), own, progress, stop));
  }
  return checks;
}

std::filesystem::path ViewOf(const std::filesystem::path& view, size_t number, const std::string& name) {
  return view.parent_path() / fmt::format("{}_{}{}", view.stem().string(), OperationFolder(number, name),
                                          view.extension().string());
}

}  // namespace millpose
