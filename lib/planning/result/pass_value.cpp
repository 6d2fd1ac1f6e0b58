// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/pass_value.hpp"

#include <algorithm>

namespace millpose {
namespace {

constexpr double kSameWay = 1e-6;  // mm

/// Whether two points ask for the same place and direction of the tool, but for rounding.
bool IsSamePlaceNearly(const MillingPoint& a, const MillingPoint& b) {
  constexpr double kRounding = 1e-9;
  return (a.position - b.position).norm() <= kRounding && a.normal == b.normal &&
         (a.tool_axis - b.tool_axis).norm() <= kRounding;
}

}  // namespace

double WayAt(size_t t, size_t count, const std::function<Eigen::Vector3d(size_t)>& place) {
  double way = 0;
  if (t > 0) way += (place(t) - place(t - 1)).norm() / 2;
  if (t + 1 < count) way += (place(t + 1) - place(t)).norm() / 2;
  return way;
}

PassValue ValueOf(const PassResult& pass) {
  PassValue value;
  value.pieces = pass.pieces.size();
  double cut = 0, sum = 0;
  const std::vector<PlannedPoint>& points = pass.points;
  for (size_t t = 0; t < points.size(); ++t) {
    const double way = WayAt(t, points.size(), [&](size_t i) { return points[i].point.position; });
    if (points[t].skip != Infeasibility::kNone) {
      value.skipped += way;
      continue;
    }
    cut += way;
    sum += way * points[t].objective;
    if (points[t].point.kind == PointKind::kCut) value.worst = std::max(value.worst, points[t].objective);
  }
  if (cut > 0) value.mean = sum / cut;
  return value;
}

bool IsBetter(const PassValue& now, const PassValue& before, bool worst_first, double gain) {
  if (std::abs(now.skipped - before.skipped) > kSameWay) return now.skipped < before.skipped;
  if (now.pieces != before.pieces) return now.pieces < before.pieces;
  if (worst_first && now.worst < before.worst * (1 - gain)) return true;
  if (worst_first && now.worst > before.worst * (1 + gain)) return false;
  return now.mean < before.mean * (1 - gain);
}

std::vector<size_t> PlacesOf(const PassResult& plan, const Pass& pass) {
  const size_t count = pass.points.size();
  std::vector<size_t> places;
  if (plan.opened_at >= static_cast<int>(count)) return places;
  const auto first = static_cast<size_t>(std::max(0, plan.opened_at));  // of a ring left open
  for (size_t i = 0; i < plan.points.size() && places.size() < count; ++i)
    if (IsSamePlaceNearly(plan.points[i].point, pass.points[(first + places.size()) % count]))
      places.push_back(i);
  return places;
}

}  // namespace millpose
