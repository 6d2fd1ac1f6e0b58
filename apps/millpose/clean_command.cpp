// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "store/output_folder.hpp"
#include "store/result_swap.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPasses = "passes";

struct CleanWords {
  std::vector<fs::path> folders;
  std::string keep;
  bool dry_run = false;
};

/// MB of the files below; `stages`: of those alone that hold results of a stage.
double MegabytesBelow(const fs::path& folder, bool stages) {
  double bytes = 0;
  std::error_code failed;
  for (auto at = fs::recursive_directory_iterator(folder, failed); !failed && at != fs::end(at);
       at.increment(failed))
    if (at->is_regular_file(failed) && !at->is_symlink(failed) &&
        (!stages || at->path().extension() == kStageEnding))
      bytes += static_cast<double>(at->file_size(failed));
  return bytes / 1e6;
}

int Clean(const CleanWords& words) {
  std::vector<Problem> problems;
  for (const fs::path& folder : words.folders)
    if (!IsOutputFolder(folder))
      problems.push_back({{folder.string()}, "is no output folder of millpose (it has no .millpose)"});
  if (!problems.empty()) throw InputError(std::move(problems));
  for (const fs::path& folder : words.folders) {
    const bool stages = words.keep == kPasses;
    const double freed = MegabytesBelow(folder / kCheckpointsFolder, stages);
    if (!words.dry_run) {
      const OutputFolder output(folder, FolderUse::kResults);
      if (stages)
        output.RemoveStages();
      else
        output.RemoveCheckpoints();
    }
    fmt::print("{:8.1f} MB {} {}\n", freed, words.dry_run ? "in" : "removed from", folder.string());
  }
  return kDone;
}

}  // namespace

void AddCleanCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "clean", "Remove the checkpoints of plans; results, programs and what verify needs stay");
  const auto words = std::make_shared<CleanWords>();
  command->add_option("DIR", words->folders, "Output folders of plan and place")->required();
  command->add_option("--keep", words->keep, "What stays: passes, so that an edit costs its passes alone")
      ->check(CLI::IsMember({kPasses}));
  command->add_flag("--dry-run", words->dry_run, "Only say how much that would free");
  command->callback([&run, words] { run = [words](Session&) { return Clean(*words); }; });
}

}  // namespace millpose
