// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/skipped.hpp"

#include <algorithm>

namespace millpose {
namespace {

/// What of a planned point holds for a skipped one too.
PlannedPoint Skipped(const PlannedPoint& planned, Infeasibility reason, const std::string& detail) {
  PlannedPoint point;
  point.point = planned.point;
  point.skip = reason;
  point.detail = detail;
  point.genetic_optimum = planned.genetic_optimum;
  point.own_optimum = planned.own_optimum;
  point.own_rotation = planned.own_rotation;
  point.own_branch = planned.own_branch;
  point.verdicts = planned.verdicts;
  point.genetic_evaluations = planned.genetic_evaluations;
  point.paper = planned.paper;
  return point;
}

}  // namespace

void LeaveOut(PassResult& pass, int piece, Infeasibility reason, const std::string& detail) {
  for (PlannedPoint& point : pass.points) {
    if (point.skip != Infeasibility::kNone || point.piece < piece) continue;
    if (point.piece == piece) {
      point = Skipped(point, reason, detail);
    } else {
      --point.piece;
    }
  }
  pass.pieces.erase(pass.pieces.begin() + piece);
  for (size_t k = static_cast<size_t>(piece); k < pass.pieces.size(); ++k)
    pass.pieces[k].piece = static_cast<int>(k);
  std::erase(pass.lifts, piece);
  for (int& lift : pass.lifts) lift -= lift > piece;
}

size_t CountPoints(const PlanResult& plan) {
  size_t count = 0;
  for (const PassResult& pass : plan.passes) count += pass.points.size();
  return count;
}

size_t CountSkipped(const PassResult& pass) {
  return static_cast<size_t>(std::ranges::count_if(
      pass.points, [](const PlannedPoint& point) { return point.skip != Infeasibility::kNone; }));
}

std::map<std::string, size_t> SkippedByReason(const PlanResult& plan) {
  std::map<std::string, size_t> counts;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      if (point.skip != Infeasibility::kNone) ++counts[ToString(point.skip)];
  return counts;
}

}  // namespace millpose
