// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/place_results.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "plan/cycle_time.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPlacementVersion = 1;
constexpr std::array<Obstacle, 5> kCauses{Obstacle::kUnreachable, Obstacle::kLimit, Obstacle::kSingular,
                                          Obstacle::kInterference, Obstacle::kStep};

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
  for (const Obstacle cause : kCauses) json[ToString(cause)] = rated.score.Count(cause);
  json["touches"] = rated.score.touches.empty() ? Json(nullptr) : Json(rated.score.touches);
  json["worst_ratio"] = OrNull(rated.worst);
  json["mean_ratio"] = OrNull(rated.mean);
  return json;
}

std::vector<std::string> CauseNames() {
  std::vector<std::string> names;
  for (const Obstacle cause : kCauses) names.push_back(ToString(cause));
  return names;
}

std::string Ratio(const std::optional<double>& ratio) {
  return ratio ? fmt::format("{:.3f}", *ratio) : std::string("-");
}

std::string PlanLine(const FoundPlaces& placement, size_t i) {
  const PlannedPlace &plan = placement.plans[i], &own = placement.plans.front();
  std::string text =
      fmt::format("{:<11}{}: {} of {} points, {} of {} gaps", i == 0 ? "job's own" : fmt::format("{}", i),
                  Describe(plan.place), plan.planned, plan.points, plan.gaps_planned, plan.gaps);
  if (i > 0)
    text += fmt::format("\n{:<11}÷ job's own: worst {} {}, median {}, worst |cF| {}, worst |n'cF| {}", "",
                        placement.objective, Ratio(RatioOf(plan.worst, own.worst)),
                        Ratio(RatioOf(plan.median, own.median)), Ratio(RatioOf(plan.length, own.length)),
                        Ratio(RatioOf(plan.normal, own.normal)));
  if (plan.clearance) text += fmt::format("\n{:<11}clearance {:.1f} mm", "", *plan.clearance);
  for (const auto& [controller, seconds] : plan.cycle)
    text += fmt::format(", {} {}", controller, ClockText(seconds));
  return text + "\n";
}

}  // namespace

std::string CauseOf(const PlaceScore& score) {
  if (!score.touches.empty()) return score.touches;
  if (score.free() == score.total()) return "";
  return ToString(*std::ranges::max_element(kCauses, {}, [&](Obstacle cause) { return score.Count(cause); }));
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
    for (const Obstacle cause : kCauses) text += fmt::format(",{}", rated.score.Count(cause));
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
  for (const PlannedPlace& plan : placement.plans) {
    const PlannedPlace& own = placement.plans.front();
    plans.push_back({{"place", PlaceJson(plan.place)},
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
                     {"cycle_s", plan.cycle}});
  }
  Json sensitivity = Json::array();
  for (const Sensitivity& one : placement.sensitivity) {
    Json json = RatedJson(one.rated);
    sensitivity.push_back({{"coordinate", kPlaceKeys[one.coordinate]}, {"by", one.by}, {"place", json}});
  }
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
                  {"sensitivity", sensitivity}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string PlacementText(const FoundPlaces& placement, const std::string& placed) {
  const auto all_free = std::ranges::count_if(
      placement.places, [](const RatedPlace& rated) { return rated.score.free() == rated.score.total(); });
  std::string text = fmt::format("places     {} looked at with {} points in each; in {} all are free\n",
                                 placement.places.size(), placement.own.score.total(), all_free);
  if (!placement.stands_on.empty())
    text += fmt::format("stands on  {}: may touch it in every place\n", fmt::join(placement.stands_on, ", "));
  for (size_t i = 0; i < placement.plans.size(); ++i) text += PlanLine(placement, i);
  if (placement.recommended == 0)
    return text + "best       no place that was planned is better than the job's own\n";
  text += fmt::format("best       {}", placement.recommended);
  if (!placed.empty()) text += ": " + placed;
  text += "\n";
  std::map<size_t, std::string> by_coordinate;
  for (const Sensitivity& one : placement.sensitivity)
    by_coordinate[one.coordinate] +=
        fmt::format("{}{:+g} {}: {}", by_coordinate[one.coordinate].empty() ? "" : ", ", one.by,
                    one.coordinate < 3 ? "mm" : "°",
                    CauseOf(one.rated.score).empty() ? Ratio(one.rated.worst) : CauseOf(one.rated.score));
  for (const auto& [coordinate, told] : by_coordinate)
    text += fmt::format("{:<11}{} {}\n", coordinate == by_coordinate.begin()->first ? "nearby" : "",
                        kPlaceKeys[coordinate], told);
  return text;
}

}  // namespace millpose
