// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/run_place.hpp"

#include <set>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "job/config/setup_names.hpp"
#include "job/step_meshes.hpp"
#include "run/pipeline/operations/done_operation.hpp"
#include "run/pipeline/outputs/run_record.hpp"
#include "run/placement/place_results.hpp"
#include "run/placement/place_search.hpp"
#include "run/placement/placed_jobs.hpp"
#include "store/remove_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr double kMoved = 20, kTurned = 1;  // mm, degrees: how well a part can be set down

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
        all_(scorer_.All()),
        rater_(inputs.size()) {}

  FoundPlaces Run(const std::string& name) {
    Describe(name);
    Search();
    Plan(space_.own(), "00_job");
    const std::vector<PoseSettings> best =
        BestPlaces(space_, found_.places, static_cast<size_t>(settings_.plans));
    for (size_t i = 0; i < best.size(); ++i) Plan(best[i], fmt::format("{:02}", i + 1));
    Recommend();
    if (settings_.stations) Split();
    const PoseSettings& at = found_.plans[found_.recommended].place;
    found_.sensitivity = LookAround(at, all_);
    DrawMap(at);
    return std::move(found_);
  }

 private:
  RatedPlace Look(const PoseSettings& place, const Samples& samples) {
    return rater_.Rate(scorer_.Score(place, samples, execution_));
  }
  RatedPlace Look(const PoseSettings& place) { return Look(place, all_); }

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
    SearchShares(std::vector<double>(space_.dimensions(), 0.5), settings_.places, inputs_.front().job.seed,
                 [&](std::span<const double> shares) {
                   stages_.Advance(1);
                   const PoseSettings place = space_.At(shares);
                   const std::array<double, 6> key = KeyOf(place);
                   if (const auto seen = known.find(key); seen != known.end()) return seen->second;
                   found_.places.push_back(Look(place));
                   return known[key] = found_.places.back().value;
                 });
    stages_.End(fmt::format("{} looked at", found_.places.size()));
  }

  void Plan(const PoseSettings& place, const std::string& name) {
    const bool own = found_.plans.empty();
    found_.plans.push_back(PlanWhole(arguments_, out_, name,
                                     own ? std::vector<Override>() : OverridesOf(place, found_.robot),
                                     execution_));
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

  /// Splits the part between more and more stations, while fewer leave something out or a gain is asked for.
  void Split() {
    StationSearch search(inputs_.front(), space_, scorer_, rater_, execution_);
    found_.split_rule = search.rule();
    for (size_t count = 2; count <= static_cast<size_t>(settings_.stations->most); ++count) {
      if (!settings_.stations->gain && Best().IsWhole()) break;
      const std::vector<SplitStation> stations = search.Find(count);
      if (stations.empty()) break;
      if (!IsPromising(stations)) continue;
      PlannedSplit& split = found_.splits.emplace_back();
      for (const SplitStation& station : stations) {
        const std::string name = fmt::format("{}_stations_{}", count, split.stations.size() + 1);
        const PoseSettings& place = station.rated.score.place;
        PlannedPlace plan = PlanWhole(
            arguments_, out_, name,
            StationOverrides(found_.job, split.stations.size() + 1, station.share, place, found_.robot),
            execution_);
        plan.place = place;
        split.stations.push_back({station.share, std::move(plan), {}});
      }
      if (Pays(split.Whole(), Best())) found_.split = found_.splits.size() - 1;
    }
    if (!found_.split) return;
    for (PlannedStation& station : found_.splits[*found_.split].stations)
      station.sensitivity = LookAround(station.plan.place, scorer_.SampleOf(station.share));
  }

  /// By the sampled points: the part stands nowhere in a body, and fewer points are missing than in any one
  /// place, where that lacks some.
  bool IsPromising(const std::vector<SplitStation>& stations) const {
    size_t free = 0, total = 0, most = found_.own.score.free();
    for (const SplitStation& station : stations) {
      if (!station.rated.score.touches.empty() || station.rated.score.free() == 0) return false;
      free += station.rated.score.free();
      total += station.rated.score.total();
    }
    const size_t wanted = found_.own.score.total();
    for (const RatedPlace& rated : found_.places) most = std::max(most, rated.score.free());
    return settings_.stations->gain || most == wanted || free * wanted > most * total;
  }

  PlannedPlace Best() const {
    return found_.split ? found_.splits[*found_.split].Whole() : found_.plans[found_.recommended];
  }

  /// Whether one more station is worth moving to.
  bool Pays(const PlannedPlace& split, const PlannedPlace& fewer) const {
    const auto left = [](const PlannedPlace& plan) {
      return std::pair(plan.points - plan.planned, plan.gaps - plan.gaps_planned);
    };
    // Points in an overlap count with both stations.
    if (left(split) != left(fewer)) return left(split) < left(fewer);
    if (!settings_.stations->gain || !split.worst.front() || !fewer.worst.front()) return false;
    return *split.worst.front() <= (1 - *settings_.stations->gain) * *fewer.worst.front();
  }

  std::vector<Sensitivity> LookAround(const PoseSettings& at, const Samples& samples) {
    std::vector<Sensitivity> sensitivity;
    for (size_t d = 0; d < space_.dimensions(); ++d) {
      const size_t i = space_.Coordinate(d);
      const bool length = i < 3;
      for (const double by : {length ? -kMoved : -kTurned, length ? kMoved : kTurned}) {
        PoseSettings place = at;
        CoordinateOf(place, i) += length ? by : DegToRad(by);
        sensitivity.push_back({i, by, Look(place, samples)});
      }
    }
    return sensitivity;
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
  const Samples& all_;
  Rater rater_;
  FoundPlaces found_;
};

const SetNames kPlaceNames{"placement.json", "placement.html", "places.csv", "map.csv",
                           "map.vtk",        kRunFile,         kManifestFile};

// Where external axes stand decides what a place is worth, and a place is scored without them.
void RefuseExternalAxes(const std::vector<JobInputs>& inputs) {
  for (const JobInputs& own : inputs)
    if (!own.cell.external_axes.empty())
      throw InputError(SourceLocation{own.cell.file},
                       "external_axes: allowed in cells that millpose place looks for places in: none");
}

// A part that is turned over stands in no one place; the robot does, whatever the part does.
void RefuseSetups(const PlaceArguments& arguments, const std::vector<JobInputs>& inputs) {
  const std::vector<std::string> setups =
      SetupNames(inputs.front().job_text, arguments.job.string(), arguments.overrides);
  if (setups.empty() || setups.front().empty()) return;
  const std::set<std::string> names(setups.begin(), setups.end());
  const auto& placement = inputs.front().job.placement;
  if (placement && placement->moves == PlaceMoves::kPart)
    throw InputError({arguments.job.string()},
                     fmt::format("setups: the part stands in each of them in its own way, and a place is "
                                 "looked for for one; allowed: placement.moves: robot, or a job of one of "
                                 "them alone ({}), with its pose as workpiece.pose",
                                 fmt::join(names, ", ")));
  for (size_t i = 0; i < inputs.size(); ++i)
    if (placement && inputs[i].job.workpiece.frame == GivenFrame::kRobotBase)
      throw InputError({arguments.job.string()},
                       fmt::format("setups.{}.frame: robot_base, so that the part would go along with the "
                                   "robot (placement.moves: robot); give its pose in the world",
                                   setups[i]));
}

// Plans of earlier runs that this one has not made. One that somebody else works in just now stays until the
// next run.
void RemoveOtherPlans(const OutputFolder& folder, const FoundPlaces& found) {
  std::set<std::string> made;
  for (const PlannedPlace& plan : found.plans) made.insert(plan.folder);
  for (const PlannedSplit& split : found.splits)
    for (const PlannedStation& station : split.stations) made.insert(station.plan.folder);
  const std::optional<Folder> plans = folder.folder().FindBelow(kPlansFolder);
  if (!plans) return;
  for (const std::string& name : plans->Names()) {
    const bool is_ours = plans->KindOf(name) == Folder::Kind::kFolder && IsOutputFolder(plans->path() / name);
    if (!is_ours || made.contains(fmt::format("{}/{}", kPlansFolder, name))) continue;
    try {
      RemoveOutputFolder(OutputFolder(plans->path() / name, FolderUse::kResults));
    } catch (const InputError&) {
    }
  }
}

}  // namespace

PlanOutcome RunPlace(const PlaceArguments& arguments, Progress& progress, const std::stop_token& stop) {
  Stages stages(progress);
  std::vector<JobInputs> inputs = LoadOperations(arguments.job, arguments.overrides, arguments.root);
  RefuseExternalAxes(inputs);
  RefuseSetups(arguments, inputs);
  const PlaceSpace checked(inputs.front().job,
                           inputs.front().cell.stated_base);  // refuses before anything is written
  CheckStations(inputs);
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
  const OutputFolder folder(out, FolderUse::kResults);
  const RunFigures begun = BeginRun(AsPlan(arguments, out), name, inputs.front().folder, folder);
  const FoundPlaces found = PlaceRun(arguments, inputs, out, stages, stop).Run(name);

  const std::vector<PlacedJob> jobs = PlacedJobs(found, inputs.front(), arguments);
  std::vector<std::string> placed;
  for (const PlacedJob& job : jobs) placed.push_back(job.file.string());
  RunFigures run = EndRun(begun, stages, Execution{arguments.threads, stages, stop}.Threads());
  run.exit_status =
      std::ranges::all_of(Recommended(found), [](const auto* plan) { return plan->IsWhole(); }) ? 0 : 1;
  run.told = PlacementText(found, placed);
  ResultSet results(folder, kPlaceNames);
  results.Add("placement.json", PlacementJson(found));
  results.Add("placement.html", PlacementPage(found, arguments.language));
  results.Add("places.csv", PlacesCsv(found.places));
  results.Add("map.csv", PlacesCsv(found.map));
  results.Add("map.vtk", PlacementMapVtk(found));
  run.manifest = results.AddManifest(KeyOf(inputs, out));
  results.AddRun(RunJson(run));
  results.Publish();
  RemoveOtherPlans(folder, found);
  WritePlacedJobs(arguments.job, jobs);
  std::string text = run.told;
  for (const std::string& warning : folder.warnings()) text += fmt::format("warning    {}\n", warning);
  return {run.exit_status, text};
}

}  // namespace millpose
