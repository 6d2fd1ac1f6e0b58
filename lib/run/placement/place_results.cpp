// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_results.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "planning/result/cycle_time.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPlacementVersion = 1;
constexpr std::array<Infeasibility, 5> kCauses{Infeasibility::kUnreachable, Infeasibility::kLimit,
                                               Infeasibility::kSingular, Infeasibility::kInterference,
                                               Infeasibility::kStep};

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json ListOf(const std::vector<std::optional<double>>& values) {
  Json list = Json::array();
  for (const std::optional<double>& value : values) list.push_back(OrNull(value));
  return list;
}

Json PlaceJson(const PoseSettings& place) {
  Json json;
  for (size_t i = 0; i < kPlaceKeys.size(); ++i) json[kPlaceKeys[i]] = ShownCoordinate(place, i);
  return json;
}

Json RatedJson(const RatedPlace& rated) {
  Json json = PlaceJson(rated.score.place);
  json["points"] = rated.score.total();
  json["free"] = rated.score.free();
  for (const Infeasibility cause : kCauses) json[ToString(cause)] = rated.score.Count(cause);
  json["touches"] = rated.score.touches.empty() ? Json(nullptr) : Json(rated.score.touches);
  json["worst_ratio"] = OrNull(rated.worst);
  json["mean_ratio"] = OrNull(rated.mean);
  return json;
}

std::vector<std::string> CauseNames() {
  std::vector<std::string> names;
  for (const Infeasibility cause : kCauses) names.push_back(ToString(cause));
  return names;
}

std::string Ratio(const std::optional<double>& ratio) {
  return ratio ? fmt::format("{:.3f}", *ratio) : std::string("-");
}

/// `where`: the place, or how many stations.
std::string PlanLine(const FoundPlaces& placement, const PlannedPlace& plan, const std::string& name,
                     const std::string& where) {
  const PlannedPlace& own = placement.plans.front();
  std::string text = fmt::format("{:<11}{}: {} of {} points, {} of {} gaps", name, where, plan.planned,
                                 plan.points, plan.gaps_planned, plan.gaps);
  if (&plan != &own)
    text += fmt::format("\n{:<11}÷ job's own: worst {} {}, median {}, worst |cF| {}, worst |n'cF| {}", "",
                        placement.objective, Ratio(RatioOf(plan.worst, own.worst)),
                        Ratio(RatioOf(plan.median, own.median)), Ratio(RatioOf(plan.length, own.length)),
                        Ratio(RatioOf(plan.normal, own.normal)));
  if (plan.clearance) text += fmt::format("\n{:<11}clearance {:.1f} mm", "", *plan.clearance);
  for (const auto& [controller, seconds] : plan.cycle)
    text += fmt::format(", {} {}", controller, ClockText(seconds));
  return text + "\n";
}

std::string SplitLines(const FoundPlaces& placement, const PlannedSplit& split) {
  const size_t count = split.stations.size();
  std::string text =
      PlanLine(placement, split.Whole(), fmt::format("{} st.", count), fmt::format("{} stations", count));
  for (const PlannedStation& station : split.stations)
    text += fmt::format("{:<11}{}: {}, {} of {} points\n", "", SpanText(station.share),
                        Describe(station.plan.place), station.plan.planned, station.plan.points);
  return text;
}

/// How well a place must be met, a line for every coordinate.
std::string NearbyLines(const std::vector<Sensitivity>& sensitivity, const std::string& name) {
  std::map<size_t, std::string> by_coordinate;
  for (const Sensitivity& one : sensitivity)
    by_coordinate[one.coordinate] +=
        fmt::format("{}{:+g} {}: {}", by_coordinate[one.coordinate].empty() ? "" : ", ", one.by,
                    one.coordinate < 3 ? "mm" : "°",
                    CauseOf(one.rated.score).empty() ? Ratio(one.rated.worst) : CauseOf(one.rated.score));
  std::string text;
  for (const auto& [coordinate, told] : by_coordinate)
    text += fmt::format("{:<11}{} {}\n", coordinate == by_coordinate.begin()->first ? name : "",
                        kPlaceKeys[coordinate], told);
  return text;
}

Json SensitivityJson(const std::vector<Sensitivity>& sensitivity) {
  Json list = Json::array();
  for (const Sensitivity& one : sensitivity) {
    Json json = RatedJson(one.rated);
    list.push_back({{"coordinate", kPlaceKeys[one.coordinate]}, {"by", one.by}, {"place", json}});
  }
  return list;
}

/// Beside the job's own place.
Json PlanJson(const PlannedPlace& plan, const PlannedPlace& own) {
  return {{"place", PlaceJson(plan.place)},
          {"folder", plan.folder},
          {"points", {{"total", plan.points}, {"planned", plan.planned}}},
          {"gaps", {{"total", plan.gaps}, {"planned", plan.gaps_planned}}},
          {"objective_worst", ListOf(plan.worst)},
          {"objective_median", ListOf(plan.median)},
          {"worst_ratio", OrNull(RatioOf(plan.worst, own.worst))},
          {"median_ratio", OrNull(RatioOf(plan.median, own.median))},
          {"length_ratio", OrNull(RatioOf(plan.length, own.length))},
          {"normal_ratio", OrNull(RatioOf(plan.normal, own.normal))},
          {"clearance_min_mm", OrNull(plan.clearance)},
          {"cycle_s", plan.cycle}};
}

Json SplitJson(const PlannedSplit& split, const PlannedPlace& own) {
  Json list = Json::array();
  for (const PlannedStation& station : split.stations) {
    const auto bound = [](double at) { return std::isfinite(at) ? Json(at) : Json(nullptr); };
    Json json{{"from_mm", bound(station.share.from)}, {"to_mm", bound(station.share.to)}};
    json.update(PlanJson(station.plan, own));
    json["sensitivity"] = SensitivityJson(station.sensitivity);
    list.push_back(json);
  }
  Json whole = PlanJson(split.Whole(), own);
  whole.erase("place");
  whole.erase("folder");
  Json json;
  json["stations"] = list;
  json.update(whole);
  return json;
}

/// null where one place was asked for.
Json StationsJson(const FoundPlaces& placement) {
  if (!placement.split_rule) return nullptr;
  const Eigen::Vector3d& along = placement.split_rule->along;
  Json splits = Json::array();
  for (const PlannedSplit& split : placement.splits)
    splits.push_back(SplitJson(split, placement.plans.front()));
  return {{"along", {along.x(), along.y(), along.z()}},
          {"overlap_mm", placement.split_rule->overlap},
          {"splits", splits},
          {"recommended", placement.split ? Json(*placement.split) : Json(nullptr)}};
}

/// The greatest of each pair; none where one of both is missing.
void TakeGreatest(const std::vector<std::optional<double>>& more,
                  std::vector<std::optional<double>>& values) {
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = values[i] && more[i] ? std::optional(std::max(*values[i], *more[i])) : std::nullopt;
}

}  // namespace

PlannedPlace PlannedSplit::Whole() const {
  PlannedPlace whole = stations.front().plan;
  for (size_t i = 1; i < stations.size(); ++i) {
    const PlannedPlace& plan = stations[i].plan;
    whole.points += plan.points;
    whole.planned += plan.planned;
    whole.gaps += plan.gaps;
    whole.gaps_planned += plan.gaps_planned;
    TakeGreatest(plan.worst, whole.worst);
    TakeGreatest(plan.median, whole.median);
    TakeGreatest(plan.length, whole.length);
    TakeGreatest(plan.normal, whole.normal);
    if (plan.clearance)
      whole.clearance = std::min(whole.clearance.value_or(*plan.clearance), *plan.clearance);
    for (const auto& [controller, seconds] : plan.cycle) whole.cycle[controller] += seconds;
  }
  return whole;
}

std::vector<const PlannedPlace*> Recommended(const FoundPlaces& placement) {
  if (!placement.split) return {&placement.plans[placement.recommended]};
  std::vector<const PlannedPlace*> plans;
  for (const PlannedStation& station : placement.splits[*placement.split].stations)
    plans.push_back(&station.plan);
  return plans;
}

std::string SpanText(const PathSection& share) {
  if (!std::isfinite(share.from)) return fmt::format("up to {} mm", ShortestNumber(share.to));
  if (!std::isfinite(share.to)) return fmt::format("from {} mm on", ShortestNumber(share.from));
  return fmt::format("{} to {} mm", ShortestNumber(share.from), ShortestNumber(share.to));
}

std::string CauseOf(const PlaceScore& score) {
  if (!score.touches.empty()) return score.touches;
  if (score.free() == score.total()) return "";
  return ToString(
      *std::ranges::max_element(kCauses, {}, [&](Infeasibility cause) { return score.Count(cause); }));
}

std::optional<double> RatioOf(const std::vector<std::optional<double>>& plan,
                              const std::vector<std::optional<double>>& own) {
  std::optional<double> greatest;
  for (size_t i = 0; i < plan.size(); ++i) {
    if (!plan[i] && !own[i]) continue;  // an operation that has none
    if (!plan[i] || !own[i] || *own[i] <= 0) return std::nullopt;
    greatest = std::max(greatest.value_or(0), *plan[i] / *own[i]);
  }
  return greatest;
}

std::string PlacesCsv(const std::vector<RatedPlace>& places) {
  std::string text = fmt::format("{},points,free,{},touches,worst_ratio,mean_ratio\n",
                                 fmt::join(kPlaceKeys, ","), fmt::join(CauseNames(), ","));
  for (const RatedPlace& rated : places) {
    for (size_t i = 0; i < kPlaceKeys.size(); ++i)
      text += ShortestNumber(ShownCoordinate(rated.score.place, i)) + ",";
    text += fmt::format("{},{}", rated.score.total(), rated.score.free());
    for (const Infeasibility cause : kCauses) text += fmt::format(",{}", rated.score.Count(cause));
    text += fmt::format(",{},{},{}\n", rated.score.touches, rated.worst ? ShortestNumber(*rated.worst) : "",
                        rated.mean ? ShortestNumber(*rated.mean) : "");
  }
  return text;
}

std::string PlacementMapVtk(const FoundPlaces& placement) {
  std::string text = fmt::format(
      "# vtk DataFile Version 3.0\nmillpose places of {}\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS {} {} "
      "1\nPOINTS {} double\n",
      placement.job, placement.map_columns, placement.map.size() / placement.map_columns,
      placement.map.size());
  for (const RatedPlace& rated : placement.map) {
    const size_t u = placement.map_coordinates[0], v = placement.map_coordinates[1];
    text += fmt::format("{} {} 0\n", ShortestNumber(ShownCoordinate(rated.score.place, u)),
                        u == v ? "0" : ShortestNumber(ShownCoordinate(rated.score.place, v)));
  }
  text += fmt::format("POINT_DATA {}\nSCALARS worst_ratio double 1\nLOOKUP_TABLE default\n",
                      placement.map.size());
  for (const RatedPlace& rated : placement.map)
    text += (rated.worst ? ShortestNumber(*rated.worst) : "0") + "\n";
  text += "SCALARS free int 1\nLOOKUP_TABLE default\n";
  for (const RatedPlace& rated : placement.map) text += fmt::format("{}\n", rated.score.free());
  return text;
}

std::string PlacementJson(const FoundPlaces& placement) {
  Json plans = Json::array();
  for (const PlannedPlace& plan : placement.plans) plans.push_back(PlanJson(plan, placement.plans.front()));
  const Json json{{"schema_version", kPlacementVersion},
                  {"job", placement.job},
                  {"moves", placement.robot ? "robot" : "part"},
                  {"objective", placement.objective},
                  {"unit", placement.unit},
                  {"operations", placement.operations},
                  {"points_looked_at", placement.sampled},
                  {"places_looked_at", placement.places.size()},
                  {"stands_on", placement.stands_on},
                  {"own", RatedJson(placement.own)},
                  {"plans", plans},
                  {"recommended", placement.recommended > 0 ? Json(placement.recommended) : Json(nullptr)},
                  {"sensitivity", SensitivityJson(placement.sensitivity)},
                  {"stations", StationsJson(placement)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string PlacementText(const FoundPlaces& placement, const std::vector<std::string>& placed) {
  const auto all_free = std::ranges::count_if(
      placement.places, [](const RatedPlace& rated) { return rated.score.free() == rated.score.total(); });
  std::string text = fmt::format("places     {} tried with {} points in each; in {} all are free\n",
                                 placement.places.size(), placement.own.score.total(), all_free);
  if (!placement.stands_on.empty())
    text += fmt::format("stands on  {}: may touch it in every place\n", fmt::join(placement.stands_on, ", "));
  for (size_t i = 0; i < placement.plans.size(); ++i) {
    const PlannedPlace& plan = placement.plans[i];
    text += PlanLine(placement, plan, i == 0 ? "job's own" : fmt::format("{}", i), Describe(plan.place));
  }
  for (const PlannedSplit& split : placement.splits) text += SplitLines(placement, split);
  if (placement.recommended == 0 && !placement.split)
    return text + "best       no place that was planned is better than the job's own\n";
  const std::string best =
      placement.split ? fmt::format("{} stations", placement.splits[*placement.split].stations.size())
                      : fmt::format("{}", placement.recommended);
  text += fmt::format("best       {}: {}\n", best, fmt::join(placed, ", "));
  if (!placement.split) return text + NearbyLines(placement.sensitivity, "nearby");
  const std::vector<PlannedStation>& stations = placement.splits[*placement.split].stations;
  for (size_t i = 0; i < stations.size(); ++i)
    text += NearbyLines(stations[i].sensitivity, fmt::format("near {}", i + 1));
  return text;
}

}  // namespace millpose
