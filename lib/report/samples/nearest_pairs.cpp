// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/samples/nearest_pairs.hpp"

#include "base/parallel.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/station.hpp"
#include "report/html_columns.hpp"

namespace millpose {
namespace {

constexpr size_t kBlock = 64;  // points that share a Checker

}  // namespace

PairsOfPoints FindPairsOfPoints(const PassResult& pass, const std::vector<size_t>& points,
                                const Stations& stations, const Execution& execution) {
  PairsOfPoints found(points.size());
  ParallelFor((points.size() + kBlock - 1) / kBlock, execution.Threads(), execution.stop, [&](size_t block) {
    std::optional<Checker> checker;
    std::shared_ptr<const Station> at;
    for (size_t i = kBlock * block; i < std::min(points.size(), kBlock * (block + 1)); ++i) {
      const std::shared_ptr<const Station> station = stations.Of(pass, points[i]);
      if (std::exchange(at, station) != station) checker.emplace(station->world);
      found[i] = checker->Nearest(pass.points[points[i]].q, Phase::kCutting, kPointClearanceBound);
    }
  });
  return found;
}

NearestPairs FindNearestPairs(
    const PlanResult& plan, const Execution& execution,
    const std::function<PairsOfPoints(const PassResult& pass, const std::vector<size_t>& points)>& find) {
  struct Asked {
    const PassResult* pass;
    std::vector<size_t> points;
    std::vector<uint32_t> numbers;
  };
  std::vector<Asked> asked;
  NearestPairs nearest;
  for (const ReportRow& row : RowsToShow(plan, ReportColumns(plan), HtmlLimits().points)) {
    const PassResult& pass = plan.passes[static_cast<size_t>(row.pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(row.point)];
    if (point.skip != Infeasibility::kNone) continue;
    nearest[row.number];  // most have none: they are not asked
    if (point.clearance >= kPointClearanceBound) continue;
    if (asked.empty() || asked.back().pass != &pass) asked.push_back({&pass, {}, {}});
    asked.back().points.push_back(static_cast<size_t>(row.point));
    asked.back().numbers.push_back(row.number);
  }
  std::vector<PairsOfPoints> found(asked.size());
  ParallelFor(asked.size(), execution.Threads(), execution.stop,
              [&](size_t i) { found[i] = find(*asked[i].pass, asked[i].points); });
  for (size_t i = 0; i < asked.size(); ++i)
    for (size_t k = 0; k < found[i].size(); ++k) nearest[asked[i].numbers[k]] = found[i][k];
  return nearest;
}

}  // namespace millpose
