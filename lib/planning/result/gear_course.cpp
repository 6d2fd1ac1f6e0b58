// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/gear_course.hpp"

#include <algorithm>
#include <numeric>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kArcmin = DegToRad(1.0 / 60);
constexpr double kMicrometre = 1e-3;

/// How far the tip goes against the part along `normal` per unit of each external axis.
std::vector<double> ExternalLevers(const Mechanism& mechanism, const PosedPoint& place) {
  std::vector<double> levers;
  for (size_t i = 0; i < place.external.size(); ++i) {
    const auto [direction, origin] = mechanism.LineOf(i, place.external);
    const bool linear = mechanism.axes()[i].kind == AxisKind::kLinear;
    const Vector3d way = linear ? direction : Vector3d(direction.cross(place.point->position - origin));
    const double sign = mechanism.axes()[i].carries == Carries::kRobot ? 1 : -1;
    levers.push_back(sign * place.point->normal.dot(way));
  }
  return levers;
}

double UnitOf(int gear, const std::vector<ExternalAxis>& external) {
  const bool linear = gear >= 6 && external[static_cast<size_t>(gear) - 6].kind == AxisKind::kLinear;
  return linear ? kMicrometre : kArcmin;
}

std::vector<PosedPoint> PlacesOfPiece(const PlanResult& plan, const PassResult& pass, const Segment& piece) {
  std::vector<PosedPoint> places;
  for (int i = piece.first; i <= piece.last; ++i) {
    const ExternalPosition& external = ExternalAt(pass, static_cast<size_t>(i));
    const PlannedPoint& planned = pass.points[static_cast<size_t>(i)];
    places.push_back({&planned.point, planned.q, BaseAt(plan, external), external});
  }
  return places;
}

}  // namespace

PosedGears GearsAt(const GearModel& model, const Arm& arm, const Pose& X_FT, const Mechanism& mechanism,
                   const PosedPoint& posed) {
  const Eigen::Matrix3d R_BW = posed.X_WB.linear().transpose();
  const Eigen::Matrix<double, 3, 6> J = Jacobian(arm, posed.q, X_FT.translation()).topRows<3>();
  PosedGears placed;
  placed.levers =
      GearLevers(model.lost, J.transpose() * (R_BW * posed.point->normal), ExternalLevers(mechanism, posed));
  placed.place.at = AtGears(model.lost, posed.q, posed.external);
  if (const auto& weights = model.weights) {
    const Joints torques =
        GravityTorques(arm, posed.q, weights->masses, weights->counterbalance, weights->gravity) +
        J.transpose() * (R_BW * posed.point->engagement.force);
    placed.place.load = GearLoads(model.lost, torques);
  }
  return placed;
}

PieceGears FollowPiece(const GearModel& model, const Arm& arm, const Pose& X_FT, const Mechanism& mechanism,
                       const std::vector<PosedPoint>& places, bool closed) {
  PieceGears gears;
  std::vector<GearPlace> way;
  const auto add = [&](const PosedPoint& posed) {
    const auto [place, levers] = GearsAt(model, arm, X_FT, mechanism, posed);
    way.push_back(place);
    gears.levers.push_back(levers);
  };
  for (const PosedPoint& posed : places) add(posed);
  if (closed && !places.empty()) add(places.front());
  gears.events = GearEvents(model.lost, way);
  const std::vector<GearValues> offsets = OffsetsAlong(model.lost, way);
  for (size_t t = 0; t < way.size(); ++t) gears.errors.push_back(gears.levers[t].dot(offsets[t]));
  return gears;
}

std::optional<double> HeightOf(const GearMark& mark, const GearModel& model) {
  if (!model.known[static_cast<size_t>(mark.gear)]) return std::nullopt;
  return mark.crosses ? model.lost.width[mark.gear] * mark.lever : 0;
}

double HeightPerUnit(const GearMark& mark, const std::vector<ExternalAxis>& external) {
  return mark.lever * UnitOf(mark.gear, external);
}

FaceFilter OfFace(const std::vector<PassResult>& passes, int finished_from) {
  return [compared = Compared(passes), finished_from](const PassResult& pass, const PlannedPoint& point) {
    return pass.pass >= finished_from && compared(point);
  };
}

GearCourse FollowGears(const PlanResult& plan, const GearModel& model, const FaceFilter& face) {
  GearCourse course;
  const Mechanism mechanism(plan.external_axes);
  const bool any_known = std::ranges::find(model.known, true) != model.known.end();
  size_t first_point = 0;
  for (const PassResult& pass : plan.passes) {
    course.errors.resize(first_point + pass.points.size());
    for (const Segment& piece : pass.pieces) {
      const std::vector<PosedPoint> places = PlacesOfPiece(plan, pass, piece);
      const PieceGears gears = FollowPiece(model, plan.arm, plan.X_FT, mechanism, places, piece.closed);
      const auto point_of = [&](size_t place) {
        return static_cast<size_t>(piece.first) + (place == places.size() ? 0 : place);
      };
      for (const GearEvent& event : gears.events) {
        const size_t at = point_of(event.place);
        if (!face(pass, pass.points[at])) continue;
        course.marks.push_back({pass.pass, first_point + at, event.gear, event.turns, event.crosses,
                                std::abs(gears.levers[event.place][event.gear])});
      }
      for (size_t t = 0; any_known && t < places.size(); ++t)
        if (face(pass, pass.points[point_of(t)])) course.errors[first_point + point_of(t)] = gears.errors[t];
    }
    first_point += pass.points.size();
  }
  std::ranges::stable_sort(course.marks, {},
                           [](const GearMark& mark) { return std::pair(mark.point, mark.gear); });
  return course;
}

int GearTally::Turns() const { return std::accumulate(turns.begin(), turns.end(), 0); }

void AddTo(GearTally& tally, const GearMark& mark, const GearModel& model,
           const std::vector<ExternalAxis>& external) {
  const auto gear = static_cast<size_t>(mark.gear);
  tally.turns[gear] += mark.turns;
  tally.crossings[gear] += mark.crosses;
  if (!mark.crosses) return;
  const double height = HeightOf(mark, model).value_or(HeightPerUnit(mark, external));
  tally.largest = std::max(tally.largest, height);
  tally.sum += height;
}

GearTally TallyOf(const GearCourse& course, const GearModel& model,
                  const std::vector<ExternalAxis>& external) {
  GearTally tally;
  for (const GearMark& mark : course.marks) AddTo(tally, mark, model, external);
  for (const std::optional<double>& error : course.errors)
    if (error) tally.worst = std::max(tally.worst, std::abs(*error));
  return tally;
}

}  // namespace millpose
