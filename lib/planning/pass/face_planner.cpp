// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_planner.hpp"

#include "base/parallel.hpp"
#include "planning/pass/describe_point.hpp"
#include "planning/pass/face_search.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "planning/pass/tell_nearest.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/continuity.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// Where leans are free: the pass with its points as they were laid, if the cutter can stand so everywhere.
std::optional<PassResult> AsLaid(const Stations& stations, const PassResult& pass) {
  const PoseProblem& problem = stations.At(pass.external).problem;
  if (!HasLean(problem)) return std::nullopt;
  PassResult laid = AtNominalLean(problem, pass);
  for (const PlannedPoint& planned : laid.points) {
    const MillingPoint& point = planned.point;
    if (planned.skip == Infeasibility::kNone && problem.lean->surface &&
        problem.lean->surface->Gouge(point.position, point.tool_axis) > 0)
      return std::nullopt;
  }
  return laid;
}

/// Puts a candidate into the plan in place of a segment. `from`: the pass with the points that it is for;
/// `leans`: its further freedoms, where they are not those of the plan.
void Put(const Stations& stations, const Segment& segment, const FaceCandidate& chosen,
         const PassResult& from, std::optional<FreedomValues> leans, PassResult& pass) {
  for (size_t i = 0; i < chosen.path.size(); ++i) {
    const size_t t = static_cast<size_t>(segment.first) + i;
    PlannedPoint& point = pass.points[t];
    const PathNode& node = chosen.path[i];
    const FreedomValues freedoms = leans.value_or(point.freedoms);
    point.point = from.points[t].point;
    DescribePoint(stations.Of(pass, t)->problem, node, point);
    for (size_t d = 1; d < freedoms.size(); ++d) point.freedoms.push_back(freedoms[d]);
    point.unsmoothed = node.objective;
    if (point.objective >= point.free_optimum) continue;
    point.free_optimum = point.objective;
    point.free_rotation = point.freedoms[0];
    point.free_branch = point.branch;
  }
}

/// The clearances at all points, as some have moved.
void MeasureClearances(const Stations& stations, PassResult& pass) {
  const PlannedIn in(stations, pass);
  pass.bodies.clear();
  for (size_t t = 0; t < pass.points.size(); ++t) {
    PlannedPoint& point = pass.points[t];
    if (point.skip != Infeasibility::kNone) continue;
    Checker checker(in.At(t).world);
    TellNearest(checker.Nearest(point.q, Phase::kCutting, kPointClearanceBound), point, pass);
  }
}

}  // namespace

double AttainableFace(const Stations& given, const PassResult& pass, const FacePlanOptions& options,
                      const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  const std::optional<PassResult> laid = AsLaid(given, pass);
  double largest = 0;
  for (const Segment& segment : pass.pieces) {
    FaceSegment face(stations, pass, segment, options, execution);
    double least = std::min(face.AsPlanned().figures.worst, FaceSearch(face, 0).Attainable());
    if (laid) {
      FaceSegment upright(stations, *laid, segment, options, execution);
      least = std::min(least, FaceSearch(upright, 0).Attainable());
    }
    largest = std::max(largest, least);
  }
  return largest;
}

PlannedFace PlanFace(const Stations& given, const PassResult& pass, const FacePlanOptions& options,
                     const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  const std::optional<PassResult> laid = AsLaid(given, pass);
  PlannedFace planned{pass, {}};
  planned.pass.bound = {};  // of a sum that is not sought
  bool changed = false;
  for (const Segment& segment : pass.pieces) {
    FaceSegment face(stations, pass, segment, options, execution);
    const FaceCandidate before = face.AsPlanned();
    std::pair best{FaceWay::kPlanned, before};
    const bool improved = FaceSearch(face, options.limit).Improve(best);
    planned.pass.poses_checked += face.poses_checked();
    bool as_laid = false;
    if (laid) {
      FaceSegment upright(stations, *laid, segment, options, execution);
      as_laid = FaceSearch(upright, options.limit).Improve(best);
      planned.pass.poses_checked += upright.poses_checked();
    }
    planned.choices.push_back({pass.pass, segment.piece, best.first, before.figures, best.second.figures});
    if (as_laid)
      Put(stations, segment, best.second, *laid, NominalFreedoms(given.problem()), planned.pass);
    else if (improved)
      Put(stations, segment, best.second, pass, std::nullopt, planned.pass);
    changed = changed || improved || as_laid;
  }
  if (changed) MeasureClearances(stations, planned.pass);
  return planned;
}

std::vector<FixedFace> FixedFacesOf(const Stations& given, const PassResult& pass,
                                    const FacePlanOptions& options, const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  const std::optional<PassResult> laid = AsLaid(given, pass);
  if (HasLean(stations.At(pass.external).problem) && !laid) return {};
  std::vector<FixedFace> faces;
  for (size_t k = 0; k < pass.pieces.size(); ++k) {
    FaceSegment face(stations, laid ? *laid : pass, pass.pieces[k], options, execution);
    const std::vector<FaceSearch::Fixed> all = FaceSearch(face, options.limit).AllFixed();
    const auto figures_at = [&](const FixedPose& at) {
      return std::ranges::find_if(all, [&](const FaceSearch::Fixed& fixed) {
        return fixed.at.place == at.place && fixed.at.branch == at.branch;
      });
    };
    if (k == 0)
      for (const FaceSearch::Fixed& fixed : all) faces.push_back({fixed.at, {}});
    std::erase_if(faces, [&](FixedFace& of) {
      const auto found = figures_at(of.at);
      if (found == all.end()) return true;
      of.face.push_back(found->figures);
      return false;
    });
  }
  std::ranges::stable_sort(faces, {},
                           [](const FixedFace& face) { return std::pair(face.at.place, face.at.branch); });
  return faces;
}

std::optional<PlannedFace> PlanFixedFace(const Stations& given, const PassResult& pass, const FixedPose& at,
                                         const FacePlanOptions& options, const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  const std::optional<PassResult> laid = AsLaid(given, pass);
  PlannedFace planned{pass, {}};
  planned.pass.bound = {};
  for (const Segment& segment : pass.pieces) {
    const FaceChoiceFigures before =
        FaceSegment(stations, pass, segment, options, execution).AsPlanned().figures;
    FaceSegment face(stations, laid ? *laid : pass, segment, options, execution);
    const std::optional<FaceCandidate> fixed = FaceSearch(face, options.limit).AtFixed(at);
    if (!fixed || face.Hits(*fixed).any()) return std::nullopt;
    planned.pass.poses_checked += face.poses_checked();
    planned.choices.push_back({pass.pass, segment.piece, FaceWay::kFixed, before, fixed->figures});
    Put(stations, segment, *fixed, laid ? *laid : pass,
        laid ? std::optional(NominalFreedoms(given.problem())) : std::nullopt, planned.pass);
  }
  MeasureClearances(stations, planned.pass);
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
      places.push_back(FaceAtPoint(in.At(t).problem, model, pass.points[t].point, ExternalAt(pass, t))
                           .At(pass.points[t].q));
    faces.push_back(FiguresOf(gears.lost, std::move(places), piece.closed));
  }
  return faces;
}

}  // namespace millpose
