// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_figures.hpp"

#include "machine/robot/angles.hpp"

namespace millpose {

FacePlace FacePlaceAt(const PoseProblem& problem, const FaceModel& model, const MillingPoint& point,
                      const Joints& q, const ExternalPosition& external) {
  FacePlace place;
  place.gears = GearsAt(model.gears, {problem.arm, problem.X_FT, Mechanism(model.external_axes)},
                        {&point, q, problem.X_WB, external});
  place.counts = point.kind == PointKind::kCut && point.engagement.side != CutSide::kAir;
  if (point.engagement.force.isZero()) return place;
  const Eigen::Matrix3d R_BW = problem.X_WB.linear().transpose();
  const Eigen::Vector3d normal = R_BW * point.normal;
  const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip
                                     ? Eigen::Vector3d(problem.X_FT.translation())
                                     : Eigen::Vector3d::Zero();
  Matrix6 C = Compliance(Jacobian(problem.arm, q, origin), problem.arm.stiffness);
  if (!problem.compliances.empty()) C += SeriesComplianceAt(problem.arm, q, origin, problem.compliances);
  const Eigen::Vector3d g = C.topLeftCorner<3, 3>() * normal;
  const ForceCone cone(R_BW * point.engagement.force, model.force);
  place.high = cone.Largest(g);
  place.low = -cone.Largest(-g);
  return place;
}

FaceChoiceFigures FiguresOf(const LostMotion& lost, std::vector<FacePlace> places, bool closed,
                            size_t* worst_at) {
  const size_t count = places.size();
  if (closed && !places.empty()) {
    FacePlace again = places.front();
    // As the way round leaves it: the short way from the last place.
    again.gears.place.at.head<6>() =
        lost.gears * NearestEquivalent(lost.axes * places.back().gears.place.at.head<6>(),
                                       lost.axes * places.front().gears.place.at.head<6>());
    places.push_back(again);
  }
  std::vector<GearPlace> way;
  for (const FacePlace& place : places) way.push_back(place.gears.place);
  const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
  FaceChoiceFigures figures;
  for (size_t t = 0; t < places.size(); ++t) {
    const FacePlace& place = places[t];
    if (!place.counts) continue;
    const double displaced = place.gears.levers.dot(offsets[t]), largest = LargestWith(place, displaced);
    if (largest > figures.worst && worst_at != nullptr) *worst_at = t % count;
    figures.worst = std::max(figures.worst, largest);
    figures.sum += largest;
    figures.middle += displaced + 0.5 * (place.low + place.high);
    ++figures.count;
  }
  if (figures.count > 0) figures.middle /= figures.count;
  for (const GearEvent& event : GearEvents(lost, way)) {
    const FacePlace& place = places[event.place];
    if (!event.crosses || !place.counts) continue;
    figures.marks += lost.width[event.gear] * std::abs(place.gears.levers[event.gear]);
    if (event.gear < 6) ++figures.crossings[static_cast<size_t>(event.gear)];
  }
  return figures;
}

}  // namespace millpose
