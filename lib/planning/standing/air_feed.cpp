// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/standing/air_feed.hpp"

#include "planning/result/continuity.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// Calls `visit(pass, point, length)` for each motion from a point of a piece to the next one, mm on the
/// part; that which closes a ring is none of them.
template <class Visit>
void ForEachMotion(const PlanResult& plan, const Visit& visit) {
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const PassResult& pass = plan.passes[p];
    for (const Segment& piece : pass.pieces) {
      std::optional<Eigen::Vector3d> before;
      for (int t = piece.first; t <= piece.last; ++t) {
        const auto point = static_cast<size_t>(t);
        if (pass.points[point].skip != Infeasibility::kNone) continue;
        const Eigen::Vector3d tip = ToolAt(plan, pass, point).translation();
        if (before) visit(p, point, (tip - *before).norm());
        before = tip;
      }
    }
  }
}

/// The points of which RaiseFeedsInAir speaks.
std::vector<std::vector<char>> LongInAir(const AirCourse& air, double longer_than, const PlanResult& plan) {
  std::vector<std::vector<char>> found;
  for (const PassResult& pass : plan.passes) found.emplace_back(pass.points.size(), 0);
  std::vector<std::pair<size_t, size_t>> run;
  double length = 0;
  const auto end_run = [&] {
    if (length > longer_than)
      for (const auto& [p, t] : run) found[p][t] = 1;
    run.clear();
    length = 0;
  };
  ForEachMotion(plan, [&](size_t p, size_t t, double way) {
    const bool goes_on = !run.empty() && run.back().first == p &&
                         plan.passes[p].points[run.back().second].piece == plan.passes[p].points[t].piece;
    const bool clear =
        air[p][t] == InAir::kClear && plan.passes[p].points[t].point.kind != PointKind::kLeadIn;
    if (!goes_on || !clear) end_run();
    if (!clear) return;
    run.emplace_back(p, t);
    length += way;
  });
  end_run();
  return found;
}

}  // namespace

std::vector<std::vector<char>> RaiseFeedsInAir(const AirCourse& air, double feed, double longer_than,
                                               PlanResult& plan) {
  std::vector<std::vector<char>> raised = LongInAir(air, longer_than, plan);
  PlanResult fast = plan;
  for (size_t p = 0; p < raised.size(); ++p)
    for (size_t t = 0; t < raised[p].size(); ++t) {
      double& own = fast.passes[p].points[t].point.feed_rate;
      if (raised[p][t]) own = std::max(own, feed);
    }
  ReduceFeeds(fast);
  for (size_t p = 0; p < raised.size(); ++p)
    for (size_t t = 0; t < raised[p].size(); ++t) {
      double& own = plan.passes[p].points[t].point.feed_rate;
      const double possible = fast.passes[p].points[t].point.feed_rate;
      raised[p][t] = raised[p][t] && possible > own;
      if (raised[p][t]) own = possible;
    }
  return raised;
}

AirTime TimeInAir(const AirCourse& air, const std::vector<std::vector<char>>& raised,
                  const PlanResult& plan) {
  AirTime time;
  ForEachMotion(plan, [&](size_t p, size_t t, double way) {
    const double seconds = way / plan.passes[p].points[t].point.feed_rate;
    time.cuts += seconds;
    if (air[p][t] != InAir::kCuts) time.nothing += seconds;
    if (air[p][t] == InAir::kClear) time.clear += seconds;
    if (!raised.empty() && raised[p][t]) time.air_feed += seconds;
  });
  return time;
}

}  // namespace millpose
