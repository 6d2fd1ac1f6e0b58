// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/ring_opening.hpp"

#include <algorithm>

namespace millpose {

bool IsOpenedRing(const Pass& pass) {
  return pass.closed && pass.opening != RingOpening::kNone && pass.points.size() > 2;
}

Pass BeginningAt(const Pass& pass, size_t start) {
  Pass turned = pass;
  if (start == 0) return turned;
  std::vector<MillingPoint>& points = turned.points;
  const double round = points.back().arc_length - points.front().arc_length +
                       (points.front().position - points.back().position).norm();
  const double first = points[start].arc_length;
  std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(start), points.end());
  for (size_t t = 0; t < points.size(); ++t)
    points[t].arc_length += (t < points.size() - start ? 0 : round) - first;
  return turned;
}

void TurnToBegin(const Pass& turned, size_t start, SplitPoints& own) {
  const auto turn = [&](auto& list) {
    if (!list.empty())
      std::rotate(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(start), list.end());
  };
  PassContext& context = *own.context;
  turn(context.scorers);
  turn(context.genetic);
  turn(context.tables);
  turn(context.verdicts);
  turn(context.optima);
  turn(context.paper);
  for (size_t t = 0; t < turned.points.size(); ++t) {
    own.points[t] = {turned.points[t], t, -1, false};
    own.milling[t] = turned.points[t];
  }
}

PassEnds RingEnds(PassEnds ends) {
  if (ends.lead == LeadShape::kNone) ends.lead = LeadShape::kArc;
  return ends;
}

void AddRingLeads(const PassEnds& ends, double spacing, int seam, std::vector<SplitPoint>& points) {
  const auto lead = [&](const SplitPoint& end, int step) {
    std::vector<SplitPoint> beyond = LeadBeyond(end, step, ends, spacing);
    for (SplitPoint& point : beyond) point.added_by = seam;
    return beyond;
  };
  if (points.front().added_by < 0) {
    std::vector<SplitPoint> in = lead(points.front(), -1);
    std::ranges::reverse(in);
    points.insert(points.begin(), in.begin(), in.end());
  }
  if (points.back().added_by < 0) {
    const std::vector<SplitPoint> out = lead(points.back(), 1);
    points.insert(points.end(), out.begin(), out.end());
  }
}

std::vector<OverlapChoice> RingChoices(double length) {
  std::vector<OverlapChoice> choices = OverlapChoices(length);
  for (size_t i = 0; i + 1 < choices.size(); i += 2) std::swap(choices[i], choices[i + 1]);
  return choices;
}

}  // namespace millpose
