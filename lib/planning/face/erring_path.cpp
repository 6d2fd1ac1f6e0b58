// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/erring_path.hpp"

#include "planning/result/station.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

using ByAxis = Eigen::Matrix<double, 6, Eigen::Dynamic>;

Matrix3d Cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The tip's motion (and turn) against the part per mm or rad of each external axis, in W.
ByAxis ByExternal(const PlanResult& plan, const ExternalPosition& external, const Vector3d& tip) {
  const Mechanism mechanism(plan.external_axes);
  ByAxis columns = ByAxis::Zero(6, static_cast<Eigen::Index>(external.size()));
  for (size_t i = 0; i < external.size(); ++i) {
    const auto [direction, origin] = mechanism.LineOf(i, external);
    const double way = mechanism.axes()[i].carries == Carries::kRobot ? 1 : -1;
    auto column = columns.col(static_cast<Eigen::Index>(i));
    if (mechanism.axes()[i].kind == AxisKind::kLinear)
      column.head<3>() = way * direction;
    else
      column << way * direction.cross(tip - origin), way * direction;
  }
  return columns;
}

/// Feed, normal × feed and normal; of a feed along the normal any two directions across it.
Matrix3d FrameOf(const MillingPoint& point) {
  const Vector3d across = point.normal.cross(point.feed);
  const bool has_feed = across.norm() > 1e-6;
  const Vector3d second = has_feed ? Vector3d(across.normalized()) : BasisOfPlane(point.normal).second;
  Matrix3d frame;
  frame << second.cross(point.normal), second, point.normal;
  return frame;
}

/// The lower three rows act like the upper three: a twist turned into another frame.
ByAxis Turned(const Matrix3d& R, const ByAxis& twists) {
  ByAxis turned(6, twists.cols());
  turned << R * twists.topRows<3>(), R * twists.bottomRows<3>();
  return turned;
}

}  // namespace

/// Makes the points of an ErringPath.
class ErringPoints {
 public:
  ErringPoints(const PlanResult& plan, const std::vector<SeriesCompliance>& compliances,
               const std::function<Joints(const Joints&)>& weight_in)
      : plan_(plan), compliances_(compliances), weight_in_(weight_in) {}

  ErringPath::Point Make(const PassResult& pass, size_t number) const {
    const PlannedPoint& planned = pass.points[number];
    const MillingPoint& milled = planned.point;
    const ExternalPosition& external = ExternalAt(pass, number);
    const Pose X_WB = BaseAt(plan_, external), X_PW = PartAt(plan_, external).inverse(Eigen::Isometry);
    const Matrix3d R_PB = X_PW.linear() * X_WB.linear();
    const Vector3d p_FT = plan_.X_FT.translation();
    const Matrix6 J = Jacobian(plan_.arm, planned.q, p_FT);
    const Matrix6 C =
        Compliance(J, plan_.arm.stiffness) +
        SeriesComplianceAt(plan_.arm, planned.q, p_FT, CompliancesAt(plan_, external, compliances_));
    ErringPath::Point point;
    point.nominal = {X_PW * milled.position, X_PW.linear() * milled.tool_axis};
    point.shift = Vector3d::Zero();
    point.R_PT = R_PB * ForwardFlange(plan_.arm, planned.q).linear() * plan_.X_FT.linear();
    const Matrix3d frame = FrameOf(milled);
    Vector3d force = milled.engagement.force;
    if (planned.compensation) {
      // What it takes out of the arm's own sag is no error of the tool: the sag is there.
      point.shift = X_PW.linear() * (planned.compensation->shift - planned.compensation->weight);
      if (!planned.compensation->force.isZero(0.0)) force = planned.compensation->force;
    }
    point.force = frame.transpose() * force;
    point.frame = X_PW.linear() * frame;
    point.by_force = Turned(R_PB, C.leftCols<3>() * R_PB.transpose());
    point.by_axis.resize(6, 6 + static_cast<Eigen::Index>(external.size()));
    point.by_axis << Turned(R_PB, J), Turned(X_PW.linear(), ByExternal(plan_, external, milled.position));
    point.q = planned.q;
    point.external = external;
    point.weight = weight_in_ ? weight_in_(planned.q) : Joints::Zero();
    return point;
  }

 private:
  const PlanResult& plan_;
  const std::vector<SeriesCompliance>& compliances_;
  const std::function<Joints(const Joints&)>& weight_in_;
};

ErringPath::ErringPath(const PlanResult& plan, const std::vector<SeriesCompliance>& compliances,
                       int finished_from, const std::function<Joints(const Joints&)>& weight_in,
                       const ArmDeviations* deviations) {
  const ErringPoints points(plan, compliances, weight_in);
  MeasuredFrame frame;
  if (deviations) {
    const std::vector<OffPlace> places = OffPlaces(plan, *deviations, finished_from);
    if (!places.empty()) frame = FrameByArm(places);
  }
  for (const PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (const Segment& piece : pass.pieces) {
      Cut& cut = cuts_.emplace_back();
      cut.pass = pass.pass;
      cut.closed = piece.closed;
      for (auto t = static_cast<size_t>(piece.first); t <= static_cast<size_t>(piece.last); ++t) {
        if (pass.points[t].skip != Infeasibility::kNone) continue;
        ErringPath::Point& point = cut.points.emplace_back(points.Make(pass, t));
        if (deviations) point.by_arm = OffByArm(plan, pass, t, *deviations).off - frame.At(point.nominal.tip);
      }
    }
  }
}

CutterPlace ErringPath::PlaceOf(const Point& point, const ToolErrors& errors, const GearValues& offset) {
  Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();
  if (errors.force > 0) {
    twist += point.by_force * (errors.force * (point.frame * (errors.force_turn * point.force)));
    twist.head<3>() += point.shift;
  }
  Eigen::VectorXd axes = offset.head(point.by_axis.cols());
  axes.head<6>() = errors.lost.axes * (offset.head<6>() + errors.gears.At(errors.lost.gears * point.q));
  twist += point.by_axis * axes;
  if (errors.geometry) twist += point.by_arm;
  twist.head<3>() += point.R_PT * errors.tip;
  twist.tail<3>() += point.R_PT * errors.lean;
  twist.head<3>() -= errors.part_shift + errors.part_turn.cross(point.nominal.tip - errors.part_centre);
  twist.tail<3>() -= errors.part_turn;
  if (!errors.part_bending.modes.empty()) {
    twist.head<3>() -= errors.part_bending.Bent(point.nominal.tip) - point.nominal.tip;
    twist.tail<3>() -= errors.part_bending.SmallTurn(point.nominal.tip);
  }
  const Vector3d turn = twist.tail<3>();
  return {point.nominal.tip + twist.head<3>(),
          (point.nominal.axis + Cross(turn) * point.nominal.axis).normalized()};
}

std::vector<GearPlace> ErringPath::WayOf(const Cut& cut, const ToolErrors& errors) {
  std::vector<GearPlace> way;
  for (const Point& point : cut.points) {
    const Vector3d force = errors.force * (point.frame * (errors.force_turn * point.force));
    const Joints torques = point.weight + point.by_axis.topLeftCorner<3, 6>().transpose() * force;
    way.push_back({AtGears(errors.lost, point.q, point.external), GearLoads(errors.lost, torques)});
  }
  return way;
}

std::vector<CutterMotion> ErringPath::Motions(const ToolErrors& errors) const {
  std::vector<CutterMotion> motions;
  for (const Cut& cut : cuts_) {
    if (cut.points.empty()) continue;
    std::vector<GearValues> offsets(cut.points.size(), GearValues::Zero());
    if (errors.lost.Any()) offsets = OffsetsAlong(errors.lost, WayOf(cut, errors));
    std::vector<CutterPlace> places;
    for (size_t i = 0; i < cut.points.size(); ++i)
      places.push_back(PlaceOf(cut.points[i], errors, offsets[i]));
    for (size_t i = 1; i < places.size(); ++i) motions.push_back({places[i - 1], places[i], cut.pass});
    if (places.size() == 1 || cut.closed) motions.push_back({places.back(), places.front(), cut.pass});
  }
  return motions;
}

}  // namespace millpose
