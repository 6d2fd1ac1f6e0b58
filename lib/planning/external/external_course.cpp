// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/external/external_course.hpp"

#include <algorithm>

#include "machine/robot/position_between.hpp"

namespace millpose {

ExternalPosition ExternalCourse::At(double share) const { return PositionBetween(from, to, share); }

ExternalCourse StandingAt(const ExternalPosition& external) { return {external, external}; }

std::vector<ExternalPosition> PositionsAlong(const ExternalCourse& course, const Pass& pass) {
  std::vector<ExternalPosition> positions;
  const double begin = pass.points.empty() ? 0 : pass.points.front().arc_length;
  const double length = pass.points.empty() ? 0 : pass.points.back().arc_length - begin;
  for (const MillingPoint& point : pass.points)
    positions.push_back(course.At(length > 0 ? (point.arc_length - begin) / length : 0));
  return positions;
}

Pass EndingWhereItBegan(Pass pass) {
  if (!pass.closed) return pass;
  const MillingPoint &first = pass.points.front(), &last = pass.points.back();
  MillingPoint again = first;
  again.arc_length = last.arc_length + (first.position - last.position).norm();
  pass.points.push_back(std::move(again));
  pass.closed = false;
  return pass;
}

bool IsSlowEnough(const ExternalCourse& course, const Pass& pass, const std::vector<ExternalAxis>& axes,
                  const CoordinatedBounds& bounds) {
  if (!course.Moves()) return true;
  const double length = pass.points.back().arc_length - pass.points.front().arc_length;
  double feed = 0;  // mm/s, the largest: a course is as steep everywhere
  for (const MillingPoint& point : pass.points) feed = std::max(feed, point.feed_rate);
  if (!(length > 0)) return false;
  for (size_t i = 0; i < axes.size(); ++i)
    if (std::abs(course.to[i] - course.from[i]) / length * feed > bounds.speed_share * axes[i].speed)
      return false;
  return true;
}

}  // namespace millpose
