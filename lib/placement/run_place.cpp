// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/run_place.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/named_progress.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "operations/done_operation.hpp"
#include "pipeline/run_record.hpp"
#include "pipeline/step_meshes.hpp"
#include "placement/place_results.hpp"
#include "placement/place_search.hpp"
#include "program/pose_text.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr const char* kPlacedHead = "# Written by millpose place; it may write over this file again.\n";
constexpr double kApart = 0.1;              // of every range: of places nearer than that one is planned
constexpr double kMoved = 20, kTurned = 1;  // mm, degrees: how well a part can be set down

/// Rates places beside the job's own.
class Rater {
 public:
  explicit Rater(size_t operations) : reference_(operations) {}

  RatedPlace Rate(PlaceScore score) {
    RatedPlace rated;
    double worst = 0, mean = 0;
    bool all = score.touches.empty();
    for (size_t i = 0; i < reference_.size(); ++i) {
      const OperationScore& own = score.operations[i];
      if (own.points.front() == 0) {
        all = false;
        continue;
      }
      // Where the job's own place has no free point, the first that has one stands for it.
      if (reference_[i].worst <= 0) reference_[i] = own;
      worst = std::max(worst, own.worst / reference_[i].worst);
      mean = std::max(mean, own.mean / reference_[i].mean);
    }
    if (all) {
      rated.worst = worst;
      rated.mean = mean;
    }
    // What is missing before the worst, the worst before the mean; bounded, so that no place is all that a
    // search sees.
    const double missing =
        1 - static_cast<double>(score.free()) / static_cast<double>(std::max<size_t>(1, score.total()));
    rated.value = worst / (1 + worst) + 1e-3 * mean / (1 + mean);
    if (missing > 0 || !all) rated.value = 2 + missing + 0.01 * rated.value;
    rated.score = std::move(score);
    return rated;
  }

 private:
  std::vector<OperationScore> reference_;
};

/// The best places that differ, best first; none that the part cannot stand in.
std::vector<PoseSettings> BestPlaces(const PlaceSpace& space, std::vector<RatedPlace> places, size_t count) {
  std::ranges::stable_sort(places, {}, &RatedPlace::value);
  const auto near = [&](const PoseSettings& a, const PoseSettings& b) {
    for (size_t d = 0; d < space.dimensions(); ++d) {
      const PlaceRange& range = space.Range(d);
      const size_t i = space.Coordinate(d);
      if (std::abs(CoordinateOf(a, i) - CoordinateOf(b, i)) > kApart * (range.to - range.from)) return false;
    }
    return true;
  };
  std::vector<PoseSettings> best;
  for (const RatedPlace& rated : places) {
    if (best.size() >= count) break;
    const PoseSettings& place = rated.score.place;
    if (!rated.score.touches.empty() || rated.score.free() == 0) continue;
    if (std::ranges::none_of(best, [&](const PoseSettings& other) { return near(place, other); }))
      best.push_back(place);
  }
  return best;
}

std::vector<Override> OverridesOf(const PoseSettings& place, bool robot) {
  const auto list = [&](size_t first) {
    return fmt::format("[{}, {}, {}]", ShortestNumber(ShownCoordinate(place, first)),
                       ShortestNumber(ShownCoordinate(place, first + 1)),
                       ShortestNumber(ShownCoordinate(place, first + 2)));
  };
  const std::string key = robot ? "base_in_world" : "workpiece.pose";
  return {{key, fmt::format("{{xyz_mm: {}, abc_deg: {}}}", list(0), list(3))}};
}

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

PlanArguments AsPlan(const PlaceArguments& arguments, const fs::path& out) {
  PlanArguments plan;
  plan.job = arguments.job;
  plan.out = out;
  plan.threads = arguments.threads;
  plan.overrides = arguments.overrides;
  plan.max_points = arguments.max_points;
  plan.root = arguments.root;
  return plan;
}

/// The whole search of one job.
class PlaceRun {
 public:
  PlaceRun(const PlaceArguments& arguments, std::vector<JobInputs>& inputs, fs::path out, Stages& stages,
           const std::stop_token& stop)
      : arguments_(arguments),
        inputs_(inputs),
        settings_(*inputs.front().job.placement),
        out_(std::move(out)),
        stages_(stages),
        execution_{arguments.threads, stages, stop},
        space_(inputs.front().job, inputs.front().cell.stated_base),
        scorer_(inputs, execution_),
        rater_(inputs.size()) {}

  FoundPlaces Run(const std::string& name) {
    Describe(name);
    Search();
    Plan(space_.own(), "00_job");
    const std::vector<PoseSettings> best =
        BestPlaces(space_, found_.places, static_cast<size_t>(settings_.plans));
    for (size_t i = 0; i < best.size(); ++i) Plan(best[i], fmt::format("{:02}", i + 1));
    Recommend();
    const PoseSettings& at = found_.plans[found_.recommended].place;
    LookAround(at);
    DrawMap(at);
    return std::move(found_);
  }

 private:
  RatedPlace Look(const PoseSettings& place) { return rater_.Rate(scorer_.Score(place, execution_)); }

  void Describe(const std::string& name) {
    const JobSettings& job = inputs_.front().job;
    found_.job = name;
    const bool one = std::ranges::all_of(
        inputs_, [&](const JobInputs& inputs) { return inputs.job.objective == job.objective; });
    found_.objective = one ? job.objective : "objective";
    if (one) found_.unit = scorer_.operations().front().problem.objective->Unit();
    for (size_t i = 0; i < inputs_.size(); ++i) {
      found_.operations.push_back(inputs_[i].job.operation);
      found_.sampled.push_back(CountPoints(scorer_.Sample(i)));
      for (const Pass& pass : scorer_.Sample(i).passes)
        for (const MillingPoint& point : pass.points) found_.sample.push_back(point.position);
    }
    found_.stands_on = scorer_.stands_on();
    const Mesh& mesh = scorer_.operations().front().surface.mesh;
    found_.part = mesh.triangles().vertices;
    found_.robot = settings_.moves == PlaceMoves::kRobot;
    const Cell& cell = scorer_.operations().front().cell;
    if (job.workpiece.frame == GivenFrame::kWorld) found_.base = cell.X_WB.translation();
    found_.X_WP = cell.X_WP;
  }

  void Search() {
    stages_.Begin("places", static_cast<size_t>(settings_.places));
    found_.own = Look(space_.own());
    std::map<std::array<double, 6>, double> known;
    SearchShares(space_.dimensions(), settings_.places, inputs_.front().job.seed,
                 [&](std::span<const double> shares) {
                   stages_.Advance(1);
                   const PoseSettings place = space_.At(shares);
                   std::array<double, 6> key{};
                   for (size_t i = 0; i < key.size(); ++i) key[i] = ShownCoordinate(place, i);
                   if (const auto seen = known.find(key); seen != known.end()) return seen->second;
                   found_.places.push_back(Look(place));
                   return known[key] = found_.places.back().value;
                 });
    stages_.End(fmt::format("{} looked at", found_.places.size()));
  }

  void Plan(const PoseSettings& place, const std::string& name) {
    PlanArguments own = AsPlan(arguments_, out_ / kPlansFolder / name);
    if (name != "00_job")
      std::ranges::copy(OverridesOf(place, found_.robot), std::back_inserter(own.overrides));
    MakeFolders(own.out->parent_path());
    NamedProgress told(stages_, "plan " + name);
    RunJob(own, told, execution_.stop);
    found_.plans.push_back(ReadPlan(out_, fmt::format("{}/{}", kPlansFolder, name), arguments_.root));
    found_.plans.back().place = place;
  }

  /// More points and gaps planned first, then the least worst value, then the least median.
  void Recommend() {
    const PlannedPlace& own = found_.plans.front();
    const auto rank = [&](const PlannedPlace& plan) {
      const double none = std::numeric_limits<double>::infinity();
      return std::tuple(plan.points - plan.planned, plan.gaps - plan.gaps_planned,
                        RatioOf(plan.worst, own.worst).value_or(none),
                        RatioOf(plan.median, own.median).value_or(none));
    };
    for (size_t i = 1; i < found_.plans.size(); ++i)
      if (rank(found_.plans[i]) < rank(found_.plans[found_.recommended])) found_.recommended = i;
  }

  void LookAround(const PoseSettings& at) {
    for (size_t d = 0; d < space_.dimensions(); ++d) {
      const size_t i = space_.Coordinate(d);
      const bool length = i < 3;
      for (const double by : {length ? -kMoved : -kTurned, length ? kMoved : kTurned}) {
        PoseSettings place = at;
        CoordinateOf(place, i) += length ? by : DegToRad(by);
        found_.sensitivity.push_back({i, by, Look(place)});
      }
    }
  }

  void DrawMap(const PoseSettings& at) {
    const auto count = static_cast<size_t>(settings_.map_points);
    std::vector<size_t> drawn;  // dimensions
    for (size_t d = 0; d < space_.dimensions(); ++d)
      if (settings_.map.empty()
              ? d < 2
              : std::ranges::find(settings_.map, kPlaceKeys[space_.Coordinate(d)]) != settings_.map.end())
        drawn.push_back(d);
    if (settings_.map.size() == 2 && settings_.map.front() != kPlaceKeys[space_.Coordinate(drawn.front())])
      std::swap(drawn[0], drawn[1]);
    const size_t rows = drawn.size() > 1 ? count : 1;
    found_.map_columns = count;
    found_.map_coordinates = {space_.Coordinate(drawn.front()), space_.Coordinate(drawn.back())};
    std::vector<PoseSettings> places;
    for (size_t row = 0; row < rows; ++row)
      for (size_t column = 0; column < count; ++column) {
        places.push_back(at);
        const auto set = [&](size_t d, size_t step) {
          const PlaceRange& range = space_.Range(d);
          CoordinateOf(places.back(), space_.Coordinate(d)) = range.from + (range.to - range.from) *
                                                                               static_cast<double>(step) /
                                                                               static_cast<double>(count - 1);
        };
        set(drawn.front(), column);
        if (rows > 1) set(drawn.back(), row);
      }
    stages_.Begin("map", places.size());
    std::vector<PlaceScore> scores(places.size());
    ParallelFor(places.size(), execution_.Threads(), execution_.stop, [&](size_t i) {
      scores[i] = scorer_.Score(places[i], {1, Silent(), execution_.stop});
      stages_.Advance(1);
    });
    for (PlaceScore& score : scores) found_.map.push_back(rater_.Rate(std::move(score)));
    stages_.End(fmt::format("{} places", places.size()));
  }

  const PlaceArguments& arguments_;
  std::vector<JobInputs>& inputs_;
  const PlacementSettings& settings_;
  fs::path out_;
  Stages& stages_;
  Execution execution_;
  PlaceSpace space_;
  PlaceScorer scorer_;
  Rater rater_;
  FoundPlaces found_;
};

/// JOB.placed.yaml: the job with the recommended place, beside it.
fs::path PlacedFile(const fs::path& job) {
  return job.parent_path() / (job.stem().string() + ".placed" + job.extension().string());
}

void RefuseForeign(const fs::path& placed) {
  if (Exists(placed) && !ReadFile(placed).starts_with(kPlacedHead))
    throw InputError(
        Place{placed.string()},
        "stands where the placed job would be written, and millpose place did not write it; move "
        "it away");
}

}  // namespace

PlanOutcome RunPlace(const PlaceArguments& arguments, Progress& progress, const std::stop_token& stop) {
  Stages stages(progress);
  std::vector<JobInputs> inputs = LoadOperations(arguments.job, arguments.overrides, arguments.root);
  const PlaceSpace checked(inputs.front().job,
                           inputs.front().cell.stated_base);  // refuses before anything is written
  const fs::path placed = PlacedFile(arguments.job);
  RefuseForeign(placed);
  for (JobInputs& own : inputs) {
    own.max_points = arguments.max_points;
    CheckPrograms(own);
    CutStepFiles(
        &own, [](int) {}, stop);
  }
  const std::string name =
      OutlineOf(inputs.front().job_text, arguments.job.string(), arguments.overrides).name;
  const fs::path out = arguments.out.value_or(FolderOf(arguments.job) / (name + ".places"));
  if (!arguments.out) arguments.root.CheckFolder(out);
  RecoverOutputFolder(out);
  const OutputFolder folder(out, FolderUse::kResults);
  const RunFigures begun = BeginRun(AsPlan(arguments, out), name, inputs.front().folder, folder);
  const FoundPlaces found = PlaceRun(arguments, inputs, out, stages, stop).Run(name);

  std::vector<Override> overrides = arguments.overrides;
  std::ranges::copy(OverridesOf(found.plans[found.recommended].place, found.robot),
                    std::back_inserter(overrides));
  overrides.push_back({"name", name + "_placed"});
  const bool better = found.recommended > 0;
  RunFigures run = EndRun(begun, stages, Execution{arguments.threads, stages, stop}.Threads());
  const PlannedPlace& best = found.plans[found.recommended];
  run.exit_status = best.planned == best.points && best.gaps_planned == best.gaps ? 0 : 1;
  run.told = PlacementText(found, better ? placed.string() : "");
  ResultSet results(folder);
  results.Add("placement.json", PlacementJson(found));
  results.Add("placement.html", PlacementPage(found));
  results.Add("places.csv", PlacesCsv(found.places));
  results.Add("map.csv", PlacesCsv(found.map));
  results.Add("map.vtk", PlacementMapVtk(found));
  run.manifest = results.AddManifest(KeyOf(inputs, out));
  results.Add(kRunFile, RunJson(run));
  results.Publish();
  if (better)
    WriteFileAtomically(
        placed, kPlacedHead + WithOverrides(inputs.front().job_text, arguments.job.string(), overrides));
  return {run.exit_status, run.told};
}

}  // namespace millpose
