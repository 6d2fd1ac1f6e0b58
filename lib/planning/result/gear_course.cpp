// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/gear_course.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kArcmin = DegToRad(1.0 / 60);
constexpr double kMicrometre = 1e-3;

double UnitOf(int gear, const std::vector<ExternalAxis>& external) {
  const bool linear = gear >= 6 && external[static_cast<size_t>(gear) - 6].kind == AxisKind::kLinear;
  return linear ? kMicrometre : kArcmin;
}

}  // namespace

std::vector<double> ExternalLevers(const Mechanism& mechanism, const MillingPoint& point,
                                   const ExternalPosition& external) {
  std::vector<double> levers;
  for (size_t i = 0; i < external.size(); ++i) {
    const auto [direction, origin] = mechanism.LineOf(i, external);
    const bool linear = mechanism.axes()[i].kind == AxisKind::kLinear;
    const Vector3d way = linear ? direction : Vector3d(direction.cross(point.position - origin));
    const double sign = mechanism.axes()[i].carries == Carries::kRobot ? 1 : -1;
    levers.push_back(sign * point.normal.dot(way));
  }
  return levers;
}

PosedGears GearsAt(const GearModel& model, const Arm& arm, const KnownPose& pose) {
  const Eigen::Matrix<double, 3, 6> J = pose.J.topRows<3>();
  PosedGears placed;
  placed.levers = GearLevers(model.lost, J.transpose() * pose.normal, pose.external_levers);
  placed.place.at = AtGears(model.lost, pose.q, pose.external);
  if (const auto& weights = model.weights) {
    const Joints torques =
        GravityTorques(arm, pose.q, pose.frames, weights->masses, weights->counterbalance, weights->gravity) +
        J.transpose() * pose.force;
    placed.place.load = GearLoads(model.lost, torques);
  }
  return placed;
}

namespace {

PosedGears GearsAtPoint(const GearModel& model, const GearedArm& geared, const PosedPoint& posed) {
  const auto& [arm, X_FT, mechanism] = geared;
  const Eigen::Matrix3d R_BW = posed.X_WB.linear().transpose();
  const LinkPoses frames = LinkFrames(arm, posed.q);
  return GearsAt(model, arm,
                 {posed.q, frames, Jacobian(arm, frames, X_FT.translation()), R_BW * posed.point->normal,
                  R_BW * posed.point->engagement.force, posed.external,
                  ExternalLevers(mechanism, *posed.point, posed.external)});
}

/// The gears at the points of a piece, a closed one back at its first.
std::vector<PosedGears> AlongPiece(const GearModel& model, const GearedArm& arm,
                                   const std::vector<PosedPoint>& places, bool closed) {
  std::vector<PosedGears> along;
  Joints near = Joints::Zero();
  const auto add = [&](PosedPoint posed) {
    if (!along.empty()) posed.q = NearestEquivalent(near, posed.q);
    near = posed.q;
    along.push_back(GearsAtPoint(model, arm, posed));
  };
  for (const PosedPoint& posed : places) add(posed);
  if (closed && !places.empty()) add(places.front());
  return along;
}

std::vector<GearPlace> WayOf(const std::vector<PosedGears>& along) {
  std::vector<GearPlace> way;
  for (const PosedGears& posed : along) way.push_back(posed.place);
  return way;
}

}  // namespace

PieceGears FollowPiece(const GearModel& model, const GearedArm& arm, const std::vector<PosedPoint>& places,
                       bool closed) {
  const std::vector<PosedGears> along = AlongPiece(model, arm, places, closed);
  const std::vector<GearPlace> way = WayOf(along);
  PieceGears gears;
  gears.events = GearEvents(model.lost, way);
  const std::vector<GearValues> offsets = OffsetsAlong(model.lost, way);
  for (size_t t = 0; t < way.size(); ++t) {
    gears.levers.push_back(along[t].levers);
    gears.errors.push_back(along[t].levers.dot(offsets[t]));
  }
  return gears;
}

std::optional<double> HeightOf(const GearMark& mark, const GearModel& model) {
  if (!model.known[static_cast<size_t>(mark.gear)]) return std::nullopt;
  return mark.crosses ? model.lost.width[mark.gear] * mark.lever : 0;
}

double HeightPerUnit(const GearMark& mark, const std::vector<ExternalAxis>& external) {
  return mark.lever * UnitOf(mark.gear, external);
}

namespace {

/// Whether a pass goes up and down along its tool axis alone, as a drilled hole does.
bool IsBore(const PassResult& pass) {
  constexpr double kBeside = 1e-3, kDeep = 0.1;  // mm
  double deep = 0;
  for (const PlannedPoint& planned : pass.points) {
    const MillingPoint& first = pass.points.front().point;
    const Vector3d beyond = planned.point.position - first.position;
    const double along = beyond.dot(first.tool_axis);
    if ((beyond - along * first.tool_axis).norm() > kBeside) return false;
    deep = std::max(deep, std::abs(along));
  }
  return deep > kDeep;
}

}  // namespace

FaceFilter OfFace(const std::vector<PassResult>& passes, int finished_from) {
  std::set<int> bores;
  for (const PassResult& pass : passes)
    if (IsBore(pass)) bores.insert(pass.pass);
  return
      [compared = Compared(passes), bores, finished_from](const PassResult& pass, const PlannedPoint& point) {
        return pass.pass >= finished_from && !bores.contains(pass.pass) && compared(point);
      };
}

void FollowPass(const GearModel& model, const GearedArm& arm, const PassResult& pass,
                const std::function<PosedPoint(size_t)>& posed, const FaceFilter& face, GearCourse& course) {
  const bool any_known = std::ranges::find(model.known, true) != model.known.end();
  const size_t first_point = course.errors.size();
  course.errors.resize(first_point + pass.points.size());
  course.lever_sums.resize(course.errors.size());
  course.periodic.resize(course.errors.size());
  for (const PlannedPoint& point : pass.points) course.face.push_back(face(pass, point));
  for (const Segment& piece : pass.pieces) {
    std::vector<PosedPoint> places;
    for (int i = piece.first; i <= piece.last; ++i) places.push_back(posed(static_cast<size_t>(i)));
    const PieceGears gears = FollowPiece(model, arm, places, piece.closed);
    const auto point_of = [&](size_t place) {
      return static_cast<size_t>(piece.first) + (place == places.size() ? 0 : place);
    };
    for (const GearEvent& event : gears.events) {
      const size_t at = point_of(event.place);
      if (course.face[first_point + at])
        course.marks.push_back({pass.pass, first_point + at, event.gear, event.turns, event.crosses,
                                std::abs(gears.levers[event.place][event.gear])});
    }
    for (size_t t = 0; t < places.size(); ++t) {
      const size_t at = first_point + point_of(t);
      if (!course.face[at]) continue;
      course.lever_sums[at] = gears.levers[t].head<6>().cwiseAbs().sum();
      if (model.error) course.periodic[at] = gears.levers[t].head<6>().cwiseAbs().dot(model.error->amplitude);
      if (any_known) course.errors[at] = gears.errors[t];
    }
  }
}

namespace {

PosedPoint PosedAt(const PlanResult& plan, const PassResult& pass, size_t point) {
  const ExternalPosition& external = ExternalAt(pass, point);
  return {&pass.points[point].point, pass.points[point].q, BaseAt(plan, external), external};
}

}  // namespace

GearCourse FollowGears(const PlanResult& plan, const GearModel& model, const FaceFilter& face) {
  GearCourse course;
  const Mechanism mechanism(plan.external_axes);
  for (const PassResult& pass : plan.passes)
    FollowPass(
        model, {plan.arm, plan.X_FT, mechanism}, pass, [&](size_t t) { return PosedAt(plan, pass, t); }, face,
        course);
  std::ranges::stable_sort(course.marks, {},
                           [](const GearMark& mark) { return std::pair(mark.point, mark.gear); });
  return course;
}

namespace {

/// Every gear with a gap.
LostMotion WithGaps(const GearModel& model, const std::vector<ExternalAxis>& external) {
  constexpr double kGap = 0.5 * kArcmin, kLinearGap = 0.01;  // rad, mm
  LostMotion lost = model.lost;
  for (int gear = 0; gear < 6 + static_cast<int>(external.size()); ++gear) {
    if (model.known[static_cast<size_t>(gear)] && lost.width[gear] > 0) continue;
    const bool linear = gear >= 6 && external[static_cast<size_t>(gear) - 6].kind == AxisKind::kLinear;
    lost.width[gear] = linear ? kLinearGap : kGap;
  }
  return lost;
}

/// Where the approach of each piece begins, by pass and number of the piece.
std::map<std::pair<int, int>, Joints> ApproachesOf(const PlanResult& plan) {
  std::map<std::pair<int, int>, Joints> approaches;
  for (const LinkMove& link : plan.gaps)
    if (link.planned && link.to_pass >= 0 && !link.joints.empty())
      approaches[{link.to_pass, link.to_piece}] = link.joints.back();
  return approaches;
}

}  // namespace

std::vector<std::vector<GearValues>> FlankLevers(const PlanResult& plan, const GearModel& model) {
  const LostMotion lost = WithGaps(model, plan.external_axes);
  const Mechanism mechanism(plan.external_axes);
  const auto approaches = ApproachesOf(plan);
  std::vector<std::vector<GearValues>> all;
  for (const PassResult& pass : plan.passes) {
    std::vector<GearValues>& flanks = all.emplace_back(pass.points.size(), GearValues::Zero());
    for (size_t number = 0; number < pass.pieces.size(); ++number) {
      const Segment& piece = pass.pieces[number];
      std::vector<PosedPoint> places;
      for (int i = piece.first; i <= piece.last; ++i)
        places.push_back(PosedAt(plan, pass, static_cast<size_t>(i)));
      const std::vector<PosedGears> along =
          AlongPiece(model, {plan.arm, plan.X_FT, mechanism}, places, piece.closed);
      std::vector<GearPlace> way = WayOf(along);
      const auto approach = approaches.find({pass.pass, static_cast<int>(number)});
      if (approach != approaches.end()) {
        GearPlace before = way.front();
        before.at = AtGears(lost, NearestEquivalent(places[0].q, approach->second), places[0].external);
        way.insert(way.begin(), before);
      }
      const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
      for (size_t t = 0; t < places.size(); ++t)
        for (int gear = 0; gear < kMostGears; ++gear)
          if (lost.width[gear] > 0)
            flanks[static_cast<size_t>(piece.first) + t][gear] =
                along[t].levers[gear] * offsets[t + way.size() - along.size()][gear] /
                (0.5 * lost.width[gear]);
    }
  }
  return all;
}

int GearTally::Turns() const { return std::accumulate(turns.begin(), turns.end(), 0); }

void GearTally::Add(const GearTally& other) {
  for (size_t i = 0; i < turns.size(); ++i) turns[i] += other.turns[i], crossings[i] += other.crossings[i];
  largest = std::max(largest, other.largest);
  sum += other.sum;
  worst = std::max(worst, other.worst);
}

GearTally TallyOf(const GearCourse& course, const GearModel& model,
                  const std::vector<ExternalAxis>& external) {
  GearTally tally;
  for (const GearMark& mark : course.marks) {
    const auto gear = static_cast<size_t>(mark.gear);
    tally.turns[gear] += mark.turns;
    tally.crossings[gear] += mark.crosses;
    if (!mark.crosses) continue;
    const double height = HeightOf(mark, model).value_or(HeightPerUnit(mark, external));
    tally.largest = std::max(tally.largest, height);
    tally.sum += height;
  }
  for (const std::optional<double>& error : course.errors)
    if (error) tally.worst = std::max(tally.worst, std::abs(*error));
  return tally;
}

}  // namespace millpose
