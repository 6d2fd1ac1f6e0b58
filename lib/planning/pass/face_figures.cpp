// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_figures.hpp"

#include "machine/robot/angles.hpp"

namespace millpose {

FaceAtPoint::FaceAtPoint(const PoseProblem& problem, const FaceModel& model, const MillingPoint& point,
                         ExternalPosition external)
    : problem_(problem),
      model_(model),
      external_(std::move(external)),
      external_levers_(ExternalLevers(Mechanism(model.external_axes), point, external_)),
      normal_(problem.X_WB.linear().transpose() * point.normal),
      force_(problem.X_WB.linear().transpose() * point.engagement.force),
      cone_(force_, model.force),
      counts_(point.kind == PointKind::kCut && point.engagement.side != CutSide::kAir) {}

FacePlace FaceAtPoint::At(const Joints& q) const {
  const Arm& arm = problem_.arm;
  const Eigen::Vector3d tip = problem_.X_FT.translation();
  const LinkPoses frames = LinkFrames(arm, q);
  const Matrix6 J = Jacobian(arm, frames, tip);
  FacePlace place;
  place.gears = GearsAt(model_.gears, arm, {q, frames, J, normal_, force_, external_, external_levers_});
  place.counts = counts_;
  if (force_.isZero()) return place;
  const bool at_tip = problem_.origin == StiffnessOrigin::kToolTip;
  const Eigen::Vector3d origin = at_tip ? tip : Eigen::Vector3d::Zero();
  Matrix6 C = Compliance(at_tip ? J : Jacobian(arm, frames, origin), arm.stiffness);
  if (!problem_.compliances.empty()) C += SeriesComplianceAt(frames, origin, problem_.compliances);
  const Eigen::Vector3d g = C.topLeftCorner<3, 3>() * normal_;
  place.high = cone_.Largest(g);
  place.low = -cone_.Largest(-g);
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
