// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/compensate.hpp"

#include <cassert>
#include <limits>

#include "machine/motion/line.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/compensation/shift.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// mm/s: how fast a shift may change on the way. A tenth of a millimetre takes a tenth of a second, which an
/// arm of any size follows.
constexpr double kShiftSpeed = 1;
/// mm: less than this is not worth another pose.
constexpr double kLeast = 1e-5;

/// What a layer has left standing at its points, to be found by place.
class LeftStanding {
 public:
  void Add(const Vector3d& position, double height) { places_.push_back({position, height}); }

  /// mm along the normal at the point nearest to `position` on the face below; 0 where none is within
  /// `reach` (mm) of the normal through it.
  double Above(const Vector3d& position, const Vector3d& normal, double reach) const {
    double nearest = reach * reach, height = 0;
    for (const Place& place : places_) {
      const Vector3d way = place.position - position;
      const double beside = (way - way.dot(normal) * normal).squaredNorm();
      if (beside >= nearest) continue;
      nearest = beside;
      height = place.height;
    }
    return height;
  }

 private:
  struct Place {
    Vector3d position;
    double height;
  };
  std::vector<Place> places_;
};

class Compensator {
 public:
  Compensator(const CompensationOptions& options, const PointForces& forces, PlanResult& plan)
      : options_(options),
        forces_(forces),
        plan_(plan),
        carrier_{plan.arm, plan.X_WB, plan.X_FT},
        per_layer_(std::max<size_t>(1, plan.passes.size() / options.layers)) {}

  CompensationCounts Run() {
    for (size_t p = 0; p < plan_.passes.size(); ++p) {
      if (p > 0 && p % per_layer_ == 0) above_ = std::exchange(here_, LeftStanding());
      RunPass(p);
    }
    return counts_;
  }

 private:
  void RunPass(size_t p) {
    PassResult& pass = plan_.passes[p];
    Stand(pass.external);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      PlannedPoint& point = pass.points[i];
      point.compensation.reset();
      if (point.external) Stand(*point.external);
      if (point.skip != Infeasibility::kNone) continue;
      point.compensation = Expected(point, forces_[p][i]);
      if (!options_.map.empty()) point.compensation->map = options_.map[p][i];
    }
    const bool finished = p / per_layer_ + 1 >= options_.layers;
    const bool shifts = finished || options_.which == CompensatedLayers::kAll;
    for (const Segment& piece : pass.pieces) {
      if (shifts) TakeOutOf(pass, piece, &Compensation::normal);
      if (shifts && options_.deflection == TakeOut::kFull) TakeOutOf(pass, piece, &Compensation::across);
    }
    for (size_t i = 0; i < pass.points.size(); ++i) {
      PlannedPoint& point = pass.points[i];
      if (!point.compensation) continue;
      if (point.external) Stand(*point.external);
      here_at_ = {p, i};
      Command(point);
    }
  }

  /// The external axes stand at `external`.
  void Stand(const ExternalPosition& external) {
    carrier_.X_WB = BaseAt(plan_, external);
    R_BW_ = carrier_.X_WB.linear().transpose();
    to_zero_ = ToZero(plan_, external);
    beside_ = CompliancesAt(plan_, external, options_.beside);
  }

  /// What a point's tip is expected to do, and between which values that lies; nothing taken out yet.
  Compensation Expected(const PlannedPoint& planned, Vector3d force) {
    const MillingPoint& point = planned.point;
    Compensation found;
    found.q = planned.q;
    if (options_.weight) found.weight = carrier_.X_WB.linear() * options_.weight(planned.q);
    if (options_.deflection == TakeOut::kOff || point.kind != PointKind::kCut || force.isZero(0.0))
      return found;
    if (const double depth = point.engagement.depth; depth > 0) {
      const double more =
          above_.Above(to_zero_ * point.position, to_zero_.linear() * point.normal, options_.cutter_radius);
      force *= std::max(0.0, (depth + more) / depth);
    }
    found.force = force;
    const ComplianceParts parts(plan_.arm, planned.q, plan_.X_FT.translation(), beside_);
    const auto along = [&](const Vector3d& direction) {
      return parts.Along(R_BW_ * direction, R_BW_ * force, options_.force, options_.stiffness);
    };
    found.normal = along(point.normal);
    found.across = along(point.normal.cross(point.feed).normalized());
    return found;
  }

  void TakeOutOf(PassResult& pass, const Segment& piece, Compensation::Along Compensation::*member) {
    std::vector<size_t> points;
    for (auto i = static_cast<size_t>(piece.first); i <= static_cast<size_t>(piece.last); ++i)
      if (pass.points[i].compensation) points.push_back(i);
    std::vector<double> amounts, times;
    for (size_t k = 0; k < points.size(); ++k) {
      const bool closing = piece.closed && k == 0;  // is passed twice, the second time in air
      amounts.push_back(closing ? 0 : TakenOut(*pass.points[points[k]].compensation.*member, options_.share));
      times.push_back(Time(pass, points[k], points[(k + 1) % points.size()]));
    }
    LimitChange(amounts, times, kShiftSpeed, piece.closed);
    for (double& amount : amounts)
      if (std::abs(amount) < kLeast) amount = 0;
    for (size_t k = 0; k < points.size(); ++k)
      (*pass.points[points[k]].compensation.*member).taken = amounts[k];
  }

  /// Of the way between two points of a pass, which is one on the part.
  double Time(const PassResult& pass, size_t from, size_t to) const {
    const MillingPoint &first = pass.points[from].point, &last = pass.points[to].point;
    if (!pass.points[to].external) return (last.position - first.position).norm() / last.feed_rate;
    return (OnPartAtZero(plan_, ExternalAt(pass, to), last.position) -
            OnPartAtZero(plan_, ExternalAt(pass, from), first.position))
               .norm() /
           last.feed_rate;
  }

  /// The pose that takes out what is to be taken out, and what then remains for the layer below.
  void Command(PlannedPoint& planned) {
    const MillingPoint& point = planned.point;
    Compensation& c = *planned.compensation;
    const Vector3d across = point.normal.cross(point.feed).normalized();
    const auto shift = [&]() -> Vector3d {
      return -c.weight - c.normal.taken * point.normal - c.across.taken * across;
    };
    if (const double length = shift().norm(); length > options_.most) {
      const double share = options_.most / length;
      c.normal.taken *= share;
      c.across.taken *= share;
      c.weight *= share;
      c.bounded = true;
      ++counts_.cut;
      counts_.largest_cut = std::max(counts_.largest_cut, length);
    }
    BoundMap(shift(), point.normal, c);
    c.shift = shift() - c.map * point.normal;
    if (options_.deviations || !c.shift.isZero(0.0)) Reach(planned);
    if (point.kind == PointKind::kCut)
      here_.Add(to_zero_ * point.position, c.normal.expected - c.normal.taken);
  }

  /// Lowers what the map takes out until the whole shift, `other` and the map's, is `most` long.
  void BoundMap(const Vector3d& other, const Vector3d& normal, Compensation& c) {
    const double length = (other - c.map * normal).norm();
    if (c.map == 0 || length <= options_.most) return;
    const double along = other.dot(normal), beside = (other - along * normal).squaredNorm();
    const double room = std::sqrt(std::max(0.0, options_.most * options_.most - beside));
    c.map = std::clamp(c.map, along - room, along + room);
    if (!c.bounded) ++counts_.cut;
    c.bounded = true;
    counts_.largest_cut = std::max(counts_.largest_cut, length);
  }

  /// Whether the arm may stand at `q`.
  bool IsAllowed(const Joints& q) const {
    return (q.array() >= plan_.arm.lower.array()).all() && (q.array() <= plan_.arm.upper.array()).all() &&
           FirstBeyond(plan_.arm.coupled_limits, q, kRevolutionRounding) == nullptr;
  }

  void Reach(PlannedPoint& planned) {
    Compensation& c = *planned.compensation;
    Pose X_WT = carrier_.ToolPose(planned.q);
    X_WT.translation() += c.shift;
    const Pose X_BF = carrier_.FlangePose(X_WT);
    const int branch = Status(plan_.arm, planned.q);
    const auto q = options_.deviations
                       ? TrueInverseNear(plan_.arm, *options_.deviations, X_BF, branch, planned.q)
                       : InverseNear(plan_.arm, X_BF, branch, planned.q);
    const bool shifted = !c.shift.isZero(0.0);
    if (!q || !IsAllowed(*q) || !IsAllowed(OwnAngles(*q))) {
      if (shifted)
        ++counts_.unreached;
      else
        counts_.out_of_reach.push_back(here_at_);
      StayNominal(planned);
      return;
    }
    c.q = *q;
    counts_.shifted += shifted;
    if (!options_.deviations) return;
    const Pose commanded = carrier_.ToolPose(c.q);
    c.arm_shift = commanded.translation() - X_WT.translation();
    c.arm_turn = RotationVector(commanded.linear() * X_WT.linear().transpose());
    Vector3d by_frames = c.arm_shift;
    if (!options_.deviations->law.IsNone()) {
      c.gear_shift = commanded.translation() - carrier_.ToolPose(OwnAngles(c.q)).translation();
      by_frames -= c.gear_shift;
      counts_.largest_gear_shift = std::max(counts_.largest_gear_shift, c.gear_shift.norm());
    }
    counts_.largest_arm_shift = std::max(counts_.largest_arm_shift, by_frames.norm());
  }

  /// Those of the arm where its controller has its joints at `q`.
  Joints OwnAngles(const Joints& q) const { return options_.deviations ? options_.deviations->law.At(q) : q; }

  void StayNominal(PlannedPoint& planned) {
    Compensation& c = *planned.compensation;
    const bool shifted = !c.shift.isZero(0.0);
    c.q = planned.q;
    c.shift.setZero();
    c.weight.setZero();
    c.arm_shift.setZero();
    c.arm_turn.setZero();
    c.gear_shift.setZero();
    c.arm_left.reset();
    c.normal.taken = c.across.taken = c.map = 0;
    if (options_.deviations && shifted) Reach(planned);
  }

 public:
  void LeavePiece(size_t p, const Segment& piece) {
    PassResult& pass = plan_.passes[p];
    Stand(pass.external);
    for (auto i = static_cast<size_t>(piece.first); i <= static_cast<size_t>(piece.last); ++i) {
      if (!pass.points[i].compensation) continue;
      if (pass.points[i].external) Stand(*pass.points[i].external);
      here_at_ = {p, i};
      StayNominal(pass.points[i]);
    }
  }

 private:
  const CompensationOptions& options_;
  const PointForces& forces_;
  PlanResult& plan_;
  Carrier carrier_;  ///< of the pass, or of a point of it, as the next three
  Eigen::Matrix3d R_BW_;
  Pose to_zero_;
  std::vector<SeriesCompliance> beside_;
  size_t per_layer_;
  LeftStanding above_, here_;
  CompensationCounts counts_;
  std::pair<size_t, size_t> here_at_;  ///< index of the pass, of the point
};

}  // namespace

bool IsOn(const CompensationOptions& options) {
  return options.deflection != TakeOut::kOff || options.weight || !options.map.empty() || options.deviations;
}

PointForces ForcesOf(const PlanResult& plan) {
  PointForces forces;
  for (const PassResult& pass : plan.passes) {
    std::vector<Vector3d>& own = forces.emplace_back();
    for (const PlannedPoint& planned : pass.points) own.push_back(planned.point.engagement.force);
  }
  return forces;
}

CompensationCounts Compensate(const CompensationOptions& options, const PointForces& forces,
                              PlanResult& plan) {
  assert(forces.size() == plan.passes.size());
  if (!IsOn(options)) return {};
  return Compensator(options, forces, plan).Run();
}

void LeaveNominal(const CompensationOptions& options, size_t pass, const Segment& piece, PlanResult& plan) {
  const PointForces none;
  Compensator(options, none, plan).LeavePiece(pass, piece);
}

namespace {

bool AnyPoint(const PlanResult& plan, const std::function<bool(const PlannedPoint&)>& is) {
  return std::ranges::any_of(plan.passes,
                             [&](const PassResult& pass) { return std::ranges::any_of(pass.points, is); });
}

}  // namespace

bool IsCompensated(const PlanResult& plan) {
  return AnyPoint(plan, [](const PlannedPoint& point) {
    return point.compensation && !point.compensation->shift.isZero(0.0);
  });
}

bool HasCommanded(const PlanResult& plan) {
  return AnyPoint(
      plan, [](const PlannedPoint& point) { return point.compensation && point.compensation->q != point.q; });
}

void SwapCommanded(std::vector<PassResult>& passes) {
  for (PassResult& pass : passes)
    for (PlannedPoint& planned : pass.points)
      if (planned.compensation) std::swap(planned.q, planned.compensation->q);
}

void ForgetCommanded(std::vector<PassResult>& passes) {
  for (PassResult& pass : passes)
    for (PlannedPoint& planned : pass.points) planned.compensation.reset();
}

PlanResult Commanded(PlanResult plan) {
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& planned : pass.points)
      if (planned.compensation) planned.q = planned.compensation->q;
  return plan;
}

}  // namespace millpose
