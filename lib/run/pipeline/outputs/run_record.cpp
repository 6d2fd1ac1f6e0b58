// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/run_record.hpp"

#include "base/process.hpp"
#include "base/text.hpp"
#include "job/origin.hpp"
#include "run/pipeline/outputs/write_results.hpp"

namespace millpose {
namespace {

// Of AskedFor(), before the word of the language; the last in it.
constexpr const char* kLanguageAsked = " lang ";

// What results depend on beside the inputs.
std::string AskedFor(const PlanArguments& arguments) {
  std::string asked = "max-points " + ShortestNumber(arguments.max_points);
  if (arguments.audit) asked += " audit";
  if (arguments.face) asked += " face";
  if (arguments.full_axis_map) asked += " axis-map full";
  if (arguments.trajectory) asked += " trajectory " + ShortestNumber(*arguments.trajectory);
  if (arguments.language != Language::kEnglish)
    asked += kLanguageAsked + WordOf(kLanguageWords, arguments.language);
  return asked;
}

}  // namespace

bool WasSaidIn(std::string_view asked, Language language) {
  if (language == Language::kEnglish) return asked.find(kLanguageAsked) == std::string_view::npos;
  return asked.ends_with(kLanguageAsked + std::string(WordOf(kLanguageWords, language)));
}

std::filesystem::path FolderOf(const std::filesystem::path& job) {
  return job.has_parent_path() ? job.parent_path() : ".";
}

std::vector<Override> OverridesOf(const PlanArguments& arguments) {
  std::vector<Override> overrides = arguments.overrides;
  if (arguments.seed) overrides.push_back({"seed", std::to_string(*arguments.seed)});
  return overrides;
}

std::filesystem::path DefaultFolder(const std::filesystem::path& job, const std::string& name) {
  const std::filesystem::path folder = FolderOf(job);
  return IsOutputFolder(folder) ? folder : folder / (name + ".out");
}

RunFigures BeginRun(const PlanArguments& arguments, const std::string& name,
                    const std::filesystem::path& job_folder, const OutputFolder& folder) {
  RunFigures run;
  run.asked = AskedFor(arguments);
  run.job_folder = KeepOrigin(job_folder, folder.path());
  run.job = JobFileFor(arguments.job, name, folder.path());
  return run;
}

RunFigures EndRun(const RunFigures& begun, const Stages& stages, int threads) {
  RunFigures run = MeasureRun(threads, MILLPOSE_VERSION);
  run.program_id = ProgramId();
  run.asked = begun.asked;
  run.job_folder = begun.job_folder;
  run.job = begun.job;
  for (const StageTime& stage : stages.times()) {
    run.stages.push_back({stage.name, stage.seconds});
    run.wall_s += stage.seconds;
  }
  return run;
}

}  // namespace millpose
