// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_planner.hpp"

#include "base/parallel.hpp"
#include "planning/pass/describe_point.hpp"
#include "planning/pass/face_search.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/continuity.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// Puts a candidate into the plan in place of a segment.
void Put(const Stations& stations, const Segment& segment, const FaceCandidate& chosen, PassResult& pass) {
  for (size_t i = 0; i < chosen.path.size(); ++i) {
    PlannedPoint& point = pass.points[static_cast<size_t>(segment.first) + i];
    const PathNode& node = chosen.path[i];
    const std::vector<double> freedoms = point.freedoms;
    DescribePoint(stations.Of(pass, static_cast<size_t>(segment.first) + i)->problem, node, point);
    for (size_t d = 1; d < freedoms.size(); ++d) point.freedoms.push_back(freedoms[d]);
    point.unsmoothed = node.objective;
    if (point.objective >= point.free_optimum) continue;
    point.free_optimum = point.objective;
    point.free_rotation = point.freedoms[0];
    point.free_branch = point.branch;
  }
}

}  // namespace

double AttainableFace(const Stations& given, const PassResult& pass, const FacePlanOptions& options,
                      const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  double largest = 0;
  for (const Segment& segment : pass.pieces) {
    FaceSegment face(stations, pass, segment, options, execution);
    largest = std::max(largest, FaceSearch(face, 0).Attainable());
  }
  return largest;
}

PlannedFace PlanFace(const Stations& given, const PassResult& pass, const FacePlanOptions& options,
                     const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  PlannedFace planned{pass, {}};
  planned.pass.bound = {};  // of a sum that is not sought
  bool changed = false;
  for (const Segment& segment : pass.pieces) {
    FaceSegment face(stations, pass, segment, options, execution);
    const auto [way, best] = FaceSearch(face, options.limit).Best();
    planned.pass.poses_checked += face.poses_checked();
    planned.choices.push_back({pass.pass, segment.piece, way, face.AsPlanned().figures, best.figures});
    if (way == FaceWay::kPlanned) continue;
    Put(stations, segment, best, planned.pass);
    changed = true;
  }
  if (!changed) return planned;
  const PlannedIn in(stations, planned.pass);
  for (size_t t = 0; t < planned.pass.points.size(); ++t) {
    PlannedPoint& point = planned.pass.points[t];
    if (point.skip != Infeasibility::kNone) continue;
    Checker checker(in.At(t).world);
    point.clearance = checker.Clearance(point.q, Phase::kCutting, kPointClearanceBound);
  }
  return planned;
}

FaceModel ModelOf(const Stations& stations, const GearModel& gears) {
  return {gears, stations.problem().objective->JudgesFace().value_or(ForceBounds{}),
          stations.world().cell().external_axes};
}

std::vector<FaceChoiceFigures> FacesOf(const Stations& given, const GearModel& gears,
                                       const PassResult& pass) {
  const Stations stations = given.AtOwnAxis();
  const FaceModel model = ModelOf(stations, gears);
  const PlannedIn in(stations, pass);
  std::vector<FaceChoiceFigures> faces;
  for (const Segment& piece : pass.pieces) {
    std::vector<FacePlace> places;
    for (auto t = static_cast<size_t>(piece.first); t <= static_cast<size_t>(piece.last); ++t)
      places.push_back(
          FacePlaceAt(in.At(t).problem, model, pass.points[t].point, pass.points[t].q, ExternalAt(pass, t)));
    faces.push_back(FiguresOf(gears.lost, std::move(places), piece.closed));
  }
  return faces;
}

}  // namespace millpose
