// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/batch.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "report/summary_version.hpp"
#include "run/batch/run_here.hpp"
#include "run/batch/slurm.hpp"
#include "run/pipeline/commands/diff_folders.hpp"
#include "run/pipeline/operations/run_job.hpp"
#include "run/pipeline/outputs/run_record.hpp"
#include "run/pipeline/outputs/up_to_date.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

// The folders of the jobs beside them are each a set of its own.
const SetNames kBatchNames{"batch.json", "batch.csv", "index.html", "junit.xml", kManifestFile};

// Each is written into by a process of its own, which cannot know that it was to stay in this folder.
void RefuseLinks(const Folder& folder, const std::vector<BatchJob>& jobs) {
  std::vector<Problem> problems;
  for (const BatchJob& job : jobs)
    if (folder.KindOf(job.name) == Folder::Kind::kOther)
      problems.push_back({SourceLocation{(folder.path() / job.name).string()},
                          "is a symbolic link or the like; allowed for the folder of a job: a folder"});
  if (!problems.empty()) throw InputError(std::move(problems));
}

// What a process wrote to stderr, without the program's name in front and the line end behind.
std::string CauseOf(std::string errors) {
  constexpr std::string_view kPrefix = "millpose: ";
  if (errors.starts_with(kPrefix)) errors.erase(0, kPrefix.size());
  while (errors.ends_with('\n')) errors.pop_back();
  return errors;
}

// What summary.json says is missing from a complete plan.
std::string Shortfall(const Json& summary) {
  std::vector<std::string> parts;
  const auto add = [&](size_t count, const char* what) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, what));
  };
  const Json& gaps = summary.at("gaps");
  add(summary.at("points").at("skipped").get<size_t>(), "points skipped");
  add(gaps.at("total").get<size_t>() - gaps.at("planned").get<size_t>(), "gaps not planned");
  add(summary.at("findings").size(), "findings on programs");
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Which points, gaps and programs they are, one line each.
std::vector<std::string> FindingsOf(const Json& summary) {
  constexpr size_t kMost = 50;
  struct Skipped {
    size_t count = 0;
    std::string first;
  };
  std::map<std::string, Skipped> skipped;  // by reason
  for (const Json& point : summary.value("skipped", Json::array())) {
    Skipped& of_reason = skipped[point.at("reason").get<std::string>()];
    if (of_reason.count++ == 0)
      of_reason.first = fmt::format("point {} (pass {}): {}", point.at("point").dump(),
                                    point.at("pass").dump(), point.at("detail").get<std::string>());
  }
  std::vector<std::string> findings;
  for (const auto& [reason, points] : skipped)
    findings.push_back(fmt::format("{} point{} skipped, {}: first {}", points.count,
                                   points.count > 1 ? "s" : "", reason, points.first));
  for (const Json& gap : summary.value("gap_remarks", Json::array()))
    if (!gap.at("planned").get<bool>())
      findings.push_back(
          fmt::format("gap {} not planned: {}", gap.at("gap").dump(), gap.at("detail").get<std::string>()));
  for (const Json& finding : summary.at("findings")) findings.push_back(finding.get<std::string>());
  if (findings.size() > kMost) {
    const size_t more = findings.size() - kMost;
    findings.resize(kMost);
    findings.push_back(fmt::format("{} more, in summary.json", more));
  }
  return findings;
}

// Programs that are confirmed but for a stated gap, one line each controller.
std::vector<std::string> RemarksOf(const Json& summary) {
  std::vector<std::string> remarks;
  for (const Json& program : summary.value("programs", Json::array())) {
    const Json bound = program.value("but_for", Json());
    if (bound.is_null()) continue;
    const std::string remark = fmt::format(
        "{}: confirmed but for a stated gap: the corner's path, bounded by {:.4f} mm and {:.4f} "
        "deg, provided that {}",
        program.at("controller").get<std::string>(), bound.at("bound_mm").get<double>(),
        bound.at("bound_deg").get<double>(), bound.at("assumption").get<std::string>());
    if (std::ranges::find(remarks, remark) == remarks.end()) remarks.push_back(remark);
  }
  return remarks;
}

std::optional<double> NumberAt(const Json& json, const char* place) {
  const Json::json_pointer pointer(place);
  if (!json.contains(pointer) || !json.at(pointer).is_number()) return std::nullopt;
  return json.at(pointer).get<double>();
}

JobFigures FiguresOf(const Json& summary, const fs::path& folder) {
  JobFigures figures;
  figures.objective = summary.at("objective").get<std::string>();
  figures.objective_unit = summary.at("stiffness").at("units").at("objective").get<std::string>();
  figures.objective_median = NumberAt(summary, "/stiffness/objective/median");
  figures.objective_worst = NumberAt(summary, "/stiffness/objective/worst");
  figures.lambda_t1_worst = NumberAt(summary, "/stiffness/lambda_t1/worst");
  figures.lambda_t2_worst = NumberAt(summary, "/stiffness/lambda_t2/worst");
  figures.lambda_n_worst = NumberAt(summary, "/stiffness/lambda_n/worst");
  figures.clearance_min = NumberAt(summary, "/clearance_min_mm");
  figures.deflection_level = NumberAt(summary, "/deflection/level_mm");
  figures.deflection_variation = NumberAt(summary, "/deflection/variation_mm");
  for (const Json& times : summary.at("cycle_times"))
    figures.cycle_s = std::max(figures.cycle_s.value_or(0), times.at("total_s").get<double>());
  figures.report = Exists(folder / "report.html");
  return figures;
}

}  // namespace

std::vector<std::string> PlanCommand(const BatchJob& job, const fs::path& folder, int threads, bool fresh) {
  std::vector<std::string> command{OwnProgram(),
                                   "plan",
                                   fs::absolute(job.file).string(),
                                   "--out",
                                   fs::absolute(folder).string(),
                                   "--threads",
                                   std::to_string(threads),
                                   "--quiet"};
  for (const Override& change : job.overrides) {
    command.push_back("--set");
    command.push_back(change.path + "=" + change.value);
  }
  if (fresh) command.push_back("--fresh");
  if (job.max_points != BatchJob{}.max_points) {
    command.push_back("--max-points");
    command.push_back(ShortestNumber(job.max_points));
  }
  if (job.language != Language::kEnglish) {
    command.push_back("--lang");
    command.push_back(WordOf(kLanguageWords, job.language));
  }
  if (const auto& root = job.root.folder()) {
    command.push_back("--root");
    command.push_back(root->string());
  }
  return command;
}

JobOutcome Judge(const fs::path& folder, int status, const std::string& errors) {
  JobOutcome outcome;
  outcome.status = status;
  if (status > 1) {
    outcome.cause = status > 128 ? fmt::format("ended by signal {}", status - 128) : CauseOf(errors);
    return outcome;
  }
  try {
    CheckManifest(folder);
    const std::string text = ReadFile(folder / "summary.json");
    CheckSummaryVersion(text, (folder / "summary.json").string());
    const Json summary = Json::parse(text);
    outcome.points = summary.at("points").at("total").get<size_t>();
    outcome.planned = summary.at("points").at("planned").get<size_t>();
    outcome.figures = FiguresOf(summary, folder);
    outcome.remarks = RemarksOf(summary);
    outcome.cause = Shortfall(summary);
    if (!outcome.cause.empty()) outcome.status = 1;
    if (outcome.status == 1) outcome.findings = FindingsOf(summary);
    const Json run = Json::parse(ReadFile(folder / kRunFile));
    outcome.wall_s = run.at("wall_s").get<double>();
    outcome.peak_memory_MB = run.at("peak_memory_MB").get<double>();
  } catch (const std::exception& error) {
    outcome.status = 3;
    outcome.cause = std::string("its results cannot be used: ") + error.what();
  }
  return outcome;
}

std::string AtManifest(const std::string& cause, const BatchJob& job) {
  std::vector<std::string> lines;
  std::istringstream stream(cause);
  for (std::string line; std::getline(stream, line);) {
    for (const Override& change : job.overrides) {
      // "FILE[:LINE:COLUMN]: KEY: …", or what is no YAML: "--set KEY:LINE:COLUMN: …"
      const size_t message = line.find(": ");
      const std::string_view about =
          std::string_view(line).substr(message == std::string::npos ? 0 : message + 2);
      const bool names_key =
          about.starts_with(change.path) && about.size() > change.path.size() &&
          std::string_view(":.[").find(about[change.path.size()]) != std::string_view::npos;
      if (change.place.line == 0 || (!names_key && !line.starts_with("--set " + change.path + ":"))) continue;
      line = fmt::format("{}: set: {}", ToString(change.place), line);
      break;
    }
    lines.push_back(std::move(line));
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

std::optional<JobOutcome> UpToDate(const BatchJob& job, const fs::path& folder) {
  try {
    if (!IsOutputFolder(folder)) return std::nullopt;
    const std::string key = KeyOf(LoadOperations(job.file, job.overrides, job.root), folder);
    if (!HoldsPlanOf(folder, key)) return std::nullopt;
    const Json run = Json::parse(ReadFile(folder / kRunFile));
    if (!WasSaidIn(run.at("asked").get<std::string>(), job.language)) return std::nullopt;
    JobOutcome outcome = Judge(folder, 0, "");
    if (outcome.status > 1) return std::nullopt;
    outcome.up_to_date = true;
    return outcome;
  } catch (const std::exception&) {  // whatever is wrong with the folder or the job: its own run will say
    return std::nullopt;
  }
}

namespace {

/// What differs from the job's plan in another batch's folder, one line each.
std::vector<std::string> ChangesFrom(const fs::path& baseline, const std::string& name,
                                     const fs::path& folder, const FileRoot& root) {
  constexpr size_t kMost = 50;
  if (!IsOutputFolder(baseline / name)) return {"baseline: has no plan of this job"};
  std::vector<std::string> lines;
  try {
    for (const Change& change : DiffFolders({baseline / name, folder, root}).changes)
      lines.push_back("baseline: " + change.Text());
  } catch (const InputError& error) {
    return {std::string("baseline: cannot be compared: ") + error.what()};
  }
  if (lines.size() > kMost) {
    const size_t more = lines.size() - kMost;
    lines.resize(kMost);
    lines.push_back(fmt::format("baseline: {} more; millpose diff lists them", more));
  }
  return lines;
}

}  // namespace

BatchOutcome RunBatch(const BatchArguments& arguments, Progress& progress, std::stop_token stop) {
  std::vector<BatchJob> jobs = CollectJobs(arguments.jobs, arguments.root);
  for (BatchJob& job : jobs) {
    job.max_points = arguments.max_points;
    job.language = arguments.language;
  }
  const OutputFolder folder(arguments.out, FolderUse::kResults);
  RefuseLinks(folder.folder(), jobs);
  std::vector<JobOutcome> outcomes;
  if (arguments.slurm) {
    auto result = RunOnSlurm(jobs, folder.path(), std::max(1, arguments.threads), arguments.fresh,
                             *arguments.slurm, progress, stop);
    if (const auto* submitted = std::get_if<std::string>(&result)) return {0, *submitted};
    outcomes = std::get<std::vector<JobOutcome>>(std::move(result));
  } else {
    const int threads =
        arguments.threads > 0 ? arguments.threads : static_cast<int>(std::thread::hardware_concurrency());
    outcomes = RunHere(jobs, folder.path(), arguments, threads, progress, stop);
  }
  for (size_t i = 0; i < jobs.size(); ++i) outcomes[i].cause = AtManifest(outcomes[i].cause, jobs[i]);
  if (!arguments.baseline.empty())
    for (size_t i = 0; i < jobs.size(); ++i)
      if (outcomes[i].status <= 1)
        std::ranges::move(
            ChangesFrom(arguments.baseline, jobs[i].name, folder.path() / jobs[i].name, arguments.root),
            std::back_inserter(outcomes[i].remarks));
  ResultSet results(folder, kBatchNames);
  results.Add("batch.json", BatchJson(jobs, outcomes));
  results.Add("batch.csv", BatchCsv(jobs, outcomes));
  results.Add("index.html", BatchIndex(jobs, outcomes, arguments.language));
  results.Add("junit.xml", JUnitXml(jobs, outcomes));
  results.AddManifest("");
  results.Publish();
  BatchOutcome outcome{0, BatchText(jobs, outcomes)};
  for (const std::string& warning : folder.warnings()) outcome.text += warning + '\n';
  for (const JobOutcome& job : outcomes) outcome.exit_status = std::max(outcome.exit_status, job.status);
  // A job ended by a signal is an internal error of the batch: the statuses stay those of millpose.
  if (outcome.exit_status > 3) outcome.exit_status = 3;
  return outcome;
}

}  // namespace millpose
