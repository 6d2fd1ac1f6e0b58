// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/plan_place.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/file.hpp"
#include "base/named_progress.hpp"
#include "base/text.hpp"
#include "program/program_name.hpp"
#include "run/pipeline/operations/done_operation.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::optional<double> NumberAt(const Json& json, const char* pointer) {
  const Json::json_pointer at(pointer);
  if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
  return json.at(at).get<double>();
}

/// The greatest absolute value in a column of a table; none where it has none.
std::optional<double> GreatestOf(const std::string& csv, std::string_view column) {
  std::optional<double> greatest;
  std::istringstream lines(csv);
  size_t at = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string cell;
    if (at == 0) {
      while (std::getline(cells, cell, ',') && cell != column) ++at;
      continue;
    }
    for (size_t i = 0; i <= at; ++i) std::getline(cells, cell, ',');
    if (const std::optional<double> value = ParseNumber(cell))
      greatest = std::max(greatest.value_or(0), std::abs(*value));
  }
  return greatest;
}

/// What summary.json files of a plan say, one or one per operation.
PlannedPlace ReadPlan(const fs::path& out, const std::string& folder, const FileRoot& root) {
  PlannedPlace plan;
  plan.folder = folder;
  const Json whole = Json::parse(root.Read(out / folder / "summary.json"));
  plan.points = whole.at("points").at("total");
  plan.planned = whole.at("points").at("planned");
  plan.gaps = whole.at("gaps").at("total");
  plan.gaps_planned = whole.at("gaps").at("planned");
  std::vector<Json> own;
  if (whole.contains("operations"))
    for (const Json& operation : whole.at("operations")) own.push_back(operation.at("summary"));
  else
    own.push_back(whole);
  for (const Json& summary : own) {
    plan.worst.push_back(NumberAt(summary, "/stiffness/objective/worst"));
    plan.median.push_back(NumberAt(summary, "/stiffness/objective/median"));
    const std::optional<double> clearance = NumberAt(summary, "/clearance_min_mm");
    if (clearance) plan.clearance = std::min(plan.clearance.value_or(*clearance), *clearance);
    for (const Json& times : summary.at("cycle_times"))
      plan.cycle[times.at("controller").get<std::string>()] += times.at("total_s").get<double>();
  }
  std::vector<std::string> folders = OperationFolders(out / folder);
  if (folders.empty()) folders.emplace_back();
  for (const std::string& operation : folders) {
    const fs::path file = out / folder / operation / "deflection.csv";
    const std::string text = Exists(file) ? root.Read(file) : std::string();
    plan.length.push_back(GreatestOf(text, "length_um"));
    plan.normal.push_back(GreatestOf(text, "normal_um"));
  }
  return plan;
}

}  // namespace

std::vector<Override> OverridesOf(const PoseSettings& place, bool robot) {
  const auto list = [&](size_t first) {
    return fmt::format("[{}, {}, {}]", ShortestNumber(ShownCoordinate(place, first)),
                       ShortestNumber(ShownCoordinate(place, first + 1)),
                       ShortestNumber(ShownCoordinate(place, first + 2)));
  };
  const std::string key = robot ? "base_in_world" : "workpiece.pose";
  return {{key, fmt::format("{{xyz_mm: {}, abc_deg: {}}}", list(0), list(3))}};
}

std::vector<Override> StationOverrides(const std::string& name, size_t number, const PathSection& share,
                                       const PoseSettings& place, bool robot) {
  // The station stands in the name of its programs too.
  const size_t longest = kProgramNameLength - 3;
  const std::string stem = name.size() <= longest ? name : LegalName(name, longest, 2);
  std::string text = fmt::format("direction: [{}, {}, {}]", ShortestNumber(share.direction.x()),
                                 ShortestNumber(share.direction.y()), ShortestNumber(share.direction.z()));
  if (std::isfinite(share.from)) text += ", from_mm: " + ShortestNumber(share.from);
  if (std::isfinite(share.to)) text += ", to_mm: " + ShortestNumber(share.to);
  if (share.overlap > 0) text += ", overlap_mm: " + ShortestNumber(share.overlap);
  std::vector<Override> overrides = OverridesOf(place, robot);
  overrides.push_back({"toolpath.share", "{" + text + "}"});
  overrides.push_back({"name", fmt::format("{}_s{}", stem, number)});
  return overrides;
}

PlanArguments AsPlan(const PlaceArguments& arguments, const fs::path& out) {
  PlanArguments plan;
  plan.job = arguments.job;
  plan.out = out;
  plan.threads = arguments.threads;
  plan.overrides = arguments.overrides;
  plan.max_points = arguments.max_points;
  plan.root = arguments.root;
  plan.language = arguments.language;
  return plan;
}

PlannedPlace PlanWhole(const PlaceArguments& arguments, const fs::path& out, const std::string& name,
                       const std::vector<Override>& changes, const Execution& execution) {
  const std::string folder = fmt::format("{}/{}", kPlansFolder, name);
  PlanArguments own = AsPlan(arguments, Folder(out).MakeBelow(folder).path());
  std::ranges::copy(changes, std::back_inserter(own.overrides));
  NamedProgress told(execution.progress, "plan " + name);
  RunJob(own, told, execution.stop);
  return ReadPlan(out, folder, arguments.root);
}

}  // namespace millpose
