// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/inspect.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "report/lifts_json.hpp"
#include "report/summary_version.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
constexpr size_t kBins = 20;

Json RowJson(const PointsTable& points, size_t row) {
  Json json;
  for (const std::string& column : points.columns()) {
    const std::string& text = points.Text(row, column);
    const std::optional<double> number = ParseNumber(text);
    json[column] = text.empty() ? Json() : number ? Json(*number) : Json(text);
  }
  return json;
}

}  // namespace

void CheckInspectOptions(const PointsTable& points, const InspectOptions& options) {
  if (options.point && *options.point >= points.size())
    throw InputError({}, fmt::format("--point: given {}; allowed: 0…{}", *options.point, points.size() - 1));
  if (!options.pass) return;
  for (size_t row = 0; row < points.size(); ++row)
    if (points.Number(row, "pass") == *options.pass) return;
  throw InputError({}, fmt::format("--pass: given {}; allowed: 0…{}", *options.pass,
                                   points.size() > 0 ? points.Text(points.size() - 1, "pass") : "none"));
}

std::vector<size_t> PlannedRows(const PointsTable& points, const std::optional<int>& pass) {
  std::vector<size_t> rows;
  for (size_t row = 0; row < points.size(); ++row)
    if (points.IsPlanned(row) && (!pass || points.Number(row, "pass") == *pass)) rows.push_back(row);
  return rows;
}

std::vector<size_t> WorstRows(const PointsTable& points, std::vector<size_t> rows, size_t count) {
  std::ranges::stable_sort(rows, std::greater(),
                           [&](size_t row) { return *points.Number(row, "objective"); });
  rows.resize(std::min(rows.size(), count));
  return rows;
}

Histogram ObjectiveHistogram(const PointsTable& points, const std::vector<size_t>& rows, size_t bins) {
  Histogram histogram;
  if (rows.empty()) return histogram;
  std::vector<double> values;
  for (const size_t row : rows) values.push_back(*points.Number(row, "objective"));
  const auto [smallest, largest] = std::ranges::minmax(values);
  if (smallest == largest) bins = 1;
  histogram.lower = smallest;
  histogram.width = (largest - smallest) / static_cast<double>(bins);
  histogram.counts.assign(bins, 0);
  for (const double value : values) {
    const double bin = histogram.width > 0 ? (value - smallest) / histogram.width : 0;
    ++histogram.counts[std::min(static_cast<size_t>(bin), bins - 1)];
  }
  return histogram;
}

std::string InspectJson(const PointsTable& points, const std::string& summary_json, const std::string& name,
                        const InspectOptions& options, const PointStory& story) {
  CheckInspectOptions(points, options);
  Json json;
  CheckSummaryVersion(summary_json, name);
  json["summary"] = Json::parse(summary_json);
  const std::vector<size_t> rows = PlannedRows(points, options.pass);
  const Histogram histogram = ObjectiveHistogram(points, rows, kBins);
  json["objective_histogram"] = {
      {"lower", histogram.lower}, {"bin_width", histogram.width}, {"counts", histogram.counts}};
  json["worst"] = Json::array();
  for (const size_t row : WorstRows(points, rows, options.worst))
    json["worst"].push_back(RowJson(points, row));
  json["point"] = options.point ? RowJson(points, *options.point) : Json();
  json["objective_over_rotation"] = Json::array();
  for (const RotationSample& sample : story.curve)
    json["objective_over_rotation"].push_back({{"rotation_deg", RadToDeg(sample.rotation)},
                                               {"branch", sample.branch},
                                               {"objective", sample.objective}});
  json["reasons"] = story.reasons;
  json["pose_steps"] = nullptr;
  if (story.steps) {
    json["pose_steps"] = Json::array();
    for (const PoseStep& step : *story.steps) json["pose_steps"].push_back(StepJson(step));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
