// SPDX-License-Identifier: GPL-3.0-or-later
// What report.html plays: the run of the plan; and what it points at: the nearest pair of a point.
#include <limits>

#include "base/units.hpp"
#include "planning/result/station.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"

namespace millpose::html {
namespace {

constexpr uint32_t kNoRow = std::numeric_limits<uint32_t>::max();

}  // namespace

Json TimelineJson(const HtmlInput& input, const std::vector<ReportRow>& rows) {
  if (!input.timeline || input.timeline->empty()) return nullptr;
  std::map<std::pair<int, int>, uint32_t> row_of;
  for (uint32_t i = 0; i < rows.size(); ++i) row_of[{rows[i].pass, rows[i].point}] = i;
  std::vector<float> time, degrees;
  std::vector<uint32_t> row, stretch, pass;
  std::vector<Eigen::Vector3d> tip;
  std::vector<Pose> bases;
  for (const RunInstant& instant : *input.timeline) {
    const auto found = row_of.find({instant.pass, instant.point});
    if (instant.point >= 0 && found == row_of.end()) continue;  // of a point that is not shown
    // A ring's last motion ends at its first point, at times full revolutions away.
    const bool same =
        found != row_of.end() &&
        input.plan.passes[static_cast<size_t>(instant.pass)].points[static_cast<size_t>(instant.point)].q ==
            instant.q;
    time.push_back(static_cast<float>(instant.time));
    stretch.push_back(static_cast<uint32_t>(instant.stretch));
    pass.push_back(instant.pass < 0 ? kNoRow : static_cast<uint32_t>(instant.pass));
    row.push_back(same ? found->second : kNoRow);
    if (same) continue;
    for (const double q : instant.q) degrees.push_back(static_cast<float>(RadToDeg(q)));
    tip.push_back(OnPartAtZero(input.plan, instant.external, instant.tip));
    bases.push_back(BaseFromPartAtZero(input.plan, instant.external));
  }
  Json json{{"seconds", input.timeline->back().time},
            {"time_s", PackFloats(time)},
            {"stretch", PackUint32(stretch)},
            {"pass", PackUint32(pass)},
            {"row", PackUint32(row)},
            {"joints_deg", PackFloats(degrees)},
            {"tip_mm", PackVectors(tip)}};
  if (MovesAlong(input.plan)) json["bases"] = PackPoses(bases);
  return json;
}

Json NearestJson(const HtmlInput& input, const std::vector<ReportRow>& rows) {
  std::vector<std::array<std::string, 2>> pairs;
  std::map<std::array<std::string, 2>, uint32_t> number_of;
  std::vector<uint32_t> pair;         // 0: not planned; 1: none is near; 2 + p: pairs[p]
  std::vector<Eigen::Vector3d> ends;  // of the rows with a pair alone
  for (const ReportRow& row : rows) {
    const PassResult& pass = input.plan.passes[static_cast<size_t>(row.pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(row.point)];
    pair.push_back(point.skip == Infeasibility::kNone ? 1 : 0);
    if (pair.back() == 0 || !point.nearest) continue;
    const NearestPair& found = *point.nearest;
    const std::array<std::string, 2> names{pass.bodies.at(static_cast<size_t>(found.first)),
                                           pass.bodies.at(static_cast<size_t>(found.second))};
    const auto [entry, fresh] = number_of.emplace(names, static_cast<uint32_t>(pairs.size()));
    if (fresh) pairs.push_back(names);
    pair.back() = 2 + entry->second;
    const ExternalPosition external = ExternalAt(pass, static_cast<size_t>(row.point));
    for (const Eigen::Vector3d& end : {found.first_end, found.second_end})
      ends.push_back(OnPartAtZero(input.plan, external, end));
  }
  return {{"pairs", pairs}, {"pair", PackUint32(pair)}, {"ends_mm", PackVectors(ends)}};
}

}  // namespace millpose::html
