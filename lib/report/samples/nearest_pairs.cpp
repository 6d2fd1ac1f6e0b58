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

NearestPairs FindNearestPairs(const PlanResult& plan, const Stations& stations, const Execution& execution) {
  struct Asked {
    uint32_t number;
    const PassResult* pass;
    size_t point;
  };
  std::vector<Asked> asked;
  NearestPairs nearest;
  for (const ReportRow& row : RowsToShow(plan, ReportColumns(plan), HtmlLimits().points)) {
    const PassResult& pass = plan.passes[static_cast<size_t>(row.pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(row.point)];
    if (point.skip != Infeasibility::kNone) continue;
    nearest[row.number];  // most have none: they are not asked
    if (point.clearance < kPointClearanceBound)
      asked.push_back({row.number, &pass, static_cast<size_t>(row.point)});
  }
  std::vector<std::optional<Interference>> found(asked.size());
  ParallelFor((asked.size() + kBlock - 1) / kBlock, execution.Threads(), execution.stop, [&](size_t block) {
    std::optional<Checker> checker;
    std::shared_ptr<const Station> at;
    for (size_t i = kBlock * block; i < std::min(asked.size(), kBlock * (block + 1)); ++i) {
      const PassResult& pass = *asked[i].pass;
      const std::shared_ptr<const Station> station = stations.Of(pass, asked[i].point);
      if (std::exchange(at, station) != station) checker.emplace(station->world);
      found[i] = checker->Nearest(pass.points[asked[i].point].q, Phase::kCutting, kPointClearanceBound);
    }
  });
  for (size_t i = 0; i < asked.size(); ++i) nearest[asked[i].number] = found[i];
  return nearest;
}

}  // namespace millpose
