// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/arm_geometry.hpp"

#include "machine/motion/rotation_vector.hpp"
#include "planning/result/station.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::Vector3d;

OffPlace OffByArm(const PlanResult& plan, const PassResult& pass, size_t number,
                  const ArmDeviations& deviations) {
  const PlannedPoint& planned = pass.points[number];
  const ExternalPosition& external = ExternalAt(pass, number);
  const Pose X_PW = PartAt(plan, external).inverse(Eigen::Isometry);
  const Matrix3d R_PB = X_PW.linear() * BaseAt(plan, external).linear();
  const Joints& q = planned.compensation ? planned.compensation->q : planned.q;
  const Pose nominal = ForwardFlange(plan.arm, q), own = TrueFlange(plan.arm, deviations, q);
  const Vector3d tip = plan.X_FT.translation();
  OffPlace place{X_PW * planned.point.position, X_PW.linear() * planned.point.normal, {}};
  place.off << R_PB * (own * tip - nominal * tip),
      R_PB * RotationVector(own.linear() * nominal.linear().transpose());
  if (planned.compensation) {
    place.off.head<3>() += X_PW.linear() * planned.compensation->arm_shift;
    place.off.tail<3>() += X_PW.linear() * planned.compensation->arm_turn;
  }
  return place;
}

FrameTwist MeasuredFrame::At(const Vector3d& position) const {
  FrameTwist there = twist;
  there.head<3>() += twist.tail<3>().cross(position - centre);
  return there;
}

MeasuredFrame FrameByArm(const std::vector<OffPlace>& places) {
  MeasuredFrame frame;
  for (const OffPlace& place : places) frame.centre += place.position / static_cast<double>(places.size());
  double size = 1;  // turns are fitted by what they move, mm
  for (const OffPlace& place : places) size = std::max(size, (place.position - frame.centre).norm());
  const auto count = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd rows(count, 6);
  Eigen::VectorXd off(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const OffPlace& place = places[static_cast<size_t>(i)];
    rows.block<1, 3>(i, 0) = place.normal.transpose();
    rows.block<1, 3>(i, 3) = ((place.position - frame.centre) / size).cross(place.normal).transpose();
    off[i] = place.normal.dot(place.off.head<3>());
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> fit;
  fit.setThreshold(1e-6);
  fit.compute(rows);
  frame.twist = fit.solve(off);
  frame.twist.tail<3>() /= size;
  return frame;
}

std::vector<OffPlace> OffPlaces(const PlanResult& plan, const ArmDeviations& deviations, int finished_from) {
  std::vector<OffPlace> places;
  for (const PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (size_t i = 0; i < pass.points.size(); ++i)
      if (pass.points[i].point.kind == PointKind::kCut && pass.points[i].skip == Infeasibility::kNone)
        places.push_back(OffByArm(plan, pass, i, deviations));
  }
  return places;
}

}  // namespace millpose
