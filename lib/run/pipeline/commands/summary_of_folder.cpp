// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/summary_of_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "planning/result/cycle_time.hpp"
#include "report/budget_json.hpp"
#include "report/points_table.hpp"
#include "report/summary_sheet.hpp"
#include "report/words/word_table.hpp"
#include "run/pipeline/commands/operation_json.hpp"
#include "store/manifest.hpp"

namespace millpose {
namespace {

using JsonTree = nlohmann::json;

constexpr const char* kComplianceColour = "#2d7bd3";  // as report.html's first three series
constexpr const char* kForceColour = "#cf4500";
constexpr const char* kLostMotionColour = "#009e73";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The folder with its summaries as trees.
struct SignedFolder {
  explicit SignedFolder(const ReportedFolder& reported)
      : several(reported.several),
        all(JsonTree::parse(several ? reported.main : reported.operations.front().summary, nullptr, false)) {
    for (const FolderOperation& one : reported.operations) operations.emplace_back(one);
  }
  bool several;
  JsonTree all;  // of the whole job
  std::vector<OperationWithTree> operations;
};

size_t CountIn(const JsonTree& summary, const char* section, const char* key) {
  return summary.at(section).at(key).get<size_t>();
}

/// "0:11:36 krl", of the controller that takes longest; "-" where no program has a time.
std::string LongestCycle(const JsonTree& summary) {
  double longest = 0;
  std::string controller;
  for (const JsonTree& time : summary.at("cycle_times"))
    if (time.at("total_s").get<double>() > longest) {
      longest = time.at("total_s").get<double>();
      controller = time.at("controller").get<std::string>();
    }
  return controller.empty() ? "-" : fmt::format("{} {}", ClockText(longest), controller);
}

std::string LeastDistance(const JsonTree& summary) {
  const JsonTree& clearance = summary.at("clearance_min_mm");
  return clearance.is_number() ? fmt::format("{:.1f}", clearance.get<double>()) : "-";
}

/// µm; 0 where no face is cut or nothing is stated.
double StatedError(const OperationWithTree& one) {
  const JsonTree& budget = one.json.at("budget");
  return budget.is_object() ? budget.at("sum_um").get<double>() : 0;
}

std::string FaceErrorText(double um) { return um > 0 ? fmt::format("{:.3g}", um) : "-"; }

/// Why an operation is not whole.
void AddReasons(const OperationWithTree& one, std::vector<std::string>& why) {
  const JsonTree& skipped = one.json.at("skipped");
  std::map<std::string, size_t> by_reason;
  for (const JsonTree& point : skipped) ++by_reason[point.at("reason").get<std::string>()];
  std::vector<std::string> counts;
  for (const auto& [reason, count] : by_reason) counts.push_back(fmt::format("{} {}", count, reason));
  if (!counts.empty()) {
    why.push_back(fmt::format("{}: {} of {} points are left out: {}.", one.name, skipped.size(),
                              CountIn(one.json, "points", "total"), fmt::join(counts, ", ")));
    why.push_back(
        fmt::format("The first is point {} of pass {}: {}", skipped.front().at("point").get<size_t>(),
                    skipped.front().at("pass").get<int>(), skipped.front().at("detail").get<std::string>()));
  }
  const size_t ways = CountIn(one.json, "gaps", "total"), planned = CountIn(one.json, "gaps", "planned");
  if (planned < ways)
    why.push_back(
        fmt::format("{}: {} of {} ways between passes are not planned.", one.name, ways - planned, ways));
}

void AddVerdict(const SignedFolder& folder, const std::vector<FolderProgram>& programs, SummarySheet& sheet) {
  for (const OperationWithTree& one : folder.operations) AddReasons(one, sheet.why);
  const bool whole = sheet.why.empty();
  const size_t withheld = static_cast<size_t>(std::ranges::count(programs, false, &FolderProgram::written));
  const size_t gaps = static_cast<size_t>(std::ranges::count_if(
      programs, [](const FolderProgram& program) { return program.read_back == "but for a stated gap"; }));
  if (whole) sheet.why.push_back("Every point is milled and every way between passes is planned.");
  if (withheld > 0)
    sheet.why.push_back(
        fmt::format("{} of {} program files are withheld: not written.", withheld, programs.size()));
  else if (programs.empty())
    sheet.why.push_back(folder.operations.front().inputs.job.programs.empty()
                            ? "The job asks for no programs."
                            : "No program file was written.");
  else
    sheet.why.push_back(gaps > 0
                            ? fmt::format("Every program file was read back and confirmed, {} of them but "
                                          "for a stated gap.",
                                          gaps)
                            : "Every program file was read back and confirmed.");
  if (!sheet.findings.empty())
    sheet.why.push_back(fmt::format("Findings: {}, on page 2.", sheet.findings.size()));
  sheet.verdict = !whole || withheld > 0 ? "INCOMPLETE" : sheet.findings.empty() ? "done" : "FINDINGS";
}

/// Sentences of the summaries under `key`, each once, with the operations that say it.
std::vector<std::string> SentencesIn(const SignedFolder& folder, const char* key) {
  if (folder.all.contains(key)) return folder.all.at(key).get<std::vector<std::string>>();
  std::vector<std::pair<std::string, std::vector<std::string>>> told;  // sentence, operations
  for (const OperationWithTree& one : folder.operations)
    for (const JsonTree& json : one.json.at(key)) {
      const std::string sentence = json.get<std::string>();
      auto known = std::ranges::find(told, sentence, [](const auto& entry) { return entry.first; });
      if (known == told.end()) known = told.insert(told.end(), {sentence, {}});
      known->second.push_back(one.name);
    }
  std::vector<std::string> sentences;
  for (const auto& [sentence, names] : told)
    sentences.push_back(
        fmt::format("operation{} {}: {}", names.size() == 1 ? "" : "s", fmt::join(names, ", "), sentence));
  return sentences;
}

void AddOperations(const SignedFolder& folder, SummarySheet& sheet) {
  sheet.operations.columns = {
      "operation",          "tool",           "points", "milled", "passes", "cycle, h:min:s",
      "least distance, mm", "face off by, µm"};
  sheet.operations.names = 2;
  for (const OperationWithTree& one : folder.operations)
    sheet.operations.rows.push_back(
        {one.name, one.inputs.cell.tool.name, fmt::format("{}", CountIn(one.json, "points", "total")),
         fmt::format("{}", CountIn(one.json, "points", "planned")), fmt::format("{}", one.plan.passes.size()),
         LongestCycle(one.json), LeastDistance(one.json), FaceErrorText(StatedError(one))});
}

void AddSources(const SignedFolder& folder, SummarySheet& sheet) {
  const OperationWithTree& worst = *std::ranges::max_element(
      folder.operations, {}, [](const OperationWithTree& one) { return StatedError(one); });
  const std::optional<Budget> budget = ReadBudget(worst.json);
  if (!budget) return;
  if (folder.several) sheet.error_of = worst.name;
  for (const BudgetRow& row : budget->rows)
    sheet.sources.push_back({row.name, row.largest ? std::optional(1e3 * *row.largest) : std::nullopt});
}

/// Column `normal_um` of deflection.csv; empty where there is no such file or the cell is.
std::vector<double> NormalDisplacements(const Folder& folder, size_t points) {
  std::vector<double> displacements(points, kNone);
  if (folder.KindOf("deflection.csv") != Folder::Kind::kFile) return displacements;
  const std::string csv = folder.Read("deflection.csv");
  std::optional<size_t> number, normal;
  for (const std::string_view line : LinesOf(csv)) {
    const std::vector<std::string> cells = SplitCells(line);
    if (!number) {
      number = static_cast<size_t>(std::ranges::find(cells, "point") - cells.begin());
      normal = static_cast<size_t>(std::ranges::find(cells, "normal_um") - cells.begin());
      continue;
    }
    if (std::max(*number, *normal) >= cells.size()) continue;
    const auto point = ParseNumber(cells[*number]), value = ParseNumber(cells[*normal]);
    if (point && value && *point >= 0 && *point < static_cast<double>(points))
      displacements[static_cast<size_t>(*point)] = std::abs(*value);
  }
  return displacements;
}

/// What the charts show, of all operations one after the other.
class Courses {
 public:
  void Add(const OperationWithTree& one, const Folder& folder, const std::string& number) {
    const PointsTable table(folder.Read("points.csv"), "points.csv");
    const std::vector<double> by_force = NormalDisplacements(folder, table.size());
    if (!number.empty()) parts_.emplace_back(passed_, number);
    size_t row = 0;
    for (const PassResult& pass : one.plan.passes) {
      for (const PlannedPoint& point : pass.points) {
        const double way = passed_ + point.point.arc_length;
        const bool planned = point.skip == Infeasibility::kNone;
        if (!planned) left_out_.push_back(way);
        way_.push_back(way);
        compliance_.push_back(planned ? 1e3 * point.indices.normal_compliance : kNone);
        force_.push_back(planned && row < by_force.size() ? by_force[row] : kNone);
        const auto lost = row < table.size() ? table.Number(row, "lost_motion_um") : std::nullopt;
        lost_.push_back(planned && lost ? std::abs(*lost) : kNone);
        ++row;
      }
      if (!way_.empty()) passed_ = way_.back();
    }
  }

  std::vector<PathCurves> Charts() const {
    std::vector<PathCurves> charts;
    const auto add = [&](const char* title, const char* unit, std::vector<PathSeries> series) {
      std::erase_if(series, [](const PathSeries& one) {
        return std::ranges::all_of(one.values, [](double value) { return std::isnan(value); });
      });
      if (!series.empty()) charts.push_back({title, unit, way_, std::move(series), parts_, left_out_, {}});
    };
    add("Compliance along the normal on the path", "µm/N",
        {{"Compliance along the normal on the path", kComplianceColour, compliance_}});
    add("Displacement along the normal on the path", "µm",
        {{"under the mean cutting force", kForceColour, force_},
         {"by lost motion", kLostMotionColour, lost_}});
    return charts;
  }

 private:
  double passed_ = 0;  // mm
  std::vector<double> way_, compliance_, force_, lost_, left_out_;
  std::vector<std::pair<double, std::string>> parts_;
};

void AddCourses(const SignedFolder& folder, const std::filesystem::path& out, SummarySheet& sheet) {
  Courses courses;
  for (size_t i = 0; i < folder.operations.size(); ++i)
    courses.Add(folder.operations[i], Folder(out / folder.operations[i].folder),
                folder.several ? std::to_string(i + 1) : "");
  sheet.courses = courses.Charts();
}

}  // namespace

std::string SummaryOfFolder(const SetupArguments& arguments) {
  const ReportedFolder reported = ReadReportedFolder(arguments);
  const SignedFolder folder(reported);
  const Manifest manifest = CheckManifest(arguments.plan);
  SummarySheet sheet;
  try {
    const JsonTree& summary = folder.all;
    sheet.job = reported.job;
    sheet.subtitle = SubtitleOf(reported);
    sheet.findings = SentencesIn(folder, "findings");
    sheet.warnings = SentencesIn(folder, "warnings");
    const std::vector<FolderProgram> programs = ProgramsIn(reported);
    AddVerdict(folder, programs, sheet);
    AddOperations(folder, sheet);
    AddSources(folder, sheet);
    double worst = 0;
    for (const OperationWithTree& one : folder.operations) worst = std::max(worst, StatedError(one));
    sheet.tiles = {{"points milled", fmt::format("{} / {}", CountIn(summary, "points", "planned"),
                                                 CountIn(summary, "points", "total"))},
                   {"cycle, h:min:s", LongestCycle(summary)},
                   {"least distance, mm", LeastDistance(summary)},
                   {"face off by, µm", FaceErrorText(worst)}};
    AddCourses(folder, arguments.plan, sheet);
    for (const FolderProgram& program : programs) {
      const auto listed = manifest.files.find(program.path);
      sheet.programs.push_back({program.controller, program.path, program.read_back,
                                listed == manifest.files.end() ? "" : listed->second.hash});
    }
    sheet.seal = fmt::format(
        "All {} files, restart programs too, stand with their hashes (XXH3, 128 bits) in manifest.json; its "
        "own "
        "hash is {}.",
        manifest.files.size(), Hash(Folder(arguments.plan).Read(kManifestFile)));
  } catch (const JsonTree::exception&) {
    throw InputError({(arguments.plan / "summary.json").string()}, "is no summary that millpose plan wrote");
  }
  return SummarySheetHtml(sheet, arguments.language);
}

}  // namespace millpose
