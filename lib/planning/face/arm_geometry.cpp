// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/arm_geometry.hpp"

#include "base/decompositions.hpp"
#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "machine/robot/angles.hpp"
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
  frame.twist = LeastSquares(rows, off, 1e-6);
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

namespace {

/// Parts of a pattern that cancel each other may be large, and what they do together is their first order.
constexpr double kSmallShare = 0.01;

ArmDeviations Beside(ArmDeviations deviations, const ArmDeviations& pattern) {
  for (size_t i = 0; i < deviations.shift.size(); ++i) {
    deviations.shift[i] += kSmallShare * pattern.shift[i];
    deviations.turn[i] += kSmallShare * pattern.turn[i];
  }
  for (const JointCoupling& pair : pattern.law.couplings)
    deviations.law.couplings.push_back({pair.joint, pair.follows, kSmallShare * pair.factor});
  return deviations;
}

}  // namespace

void TellWhatIsLeft(const ArmDeviations& deviations, const std::vector<ArmDeviations>& patterns,
                    int finished_from, PlanResult& plan) {
  constexpr double kWithin95 = 1.959963984540054;
  if (patterns.empty()) return;
  const std::vector<OffPlace> known = OffPlaces(plan, deviations, finished_from);
  std::vector<double> squares(known.size(), 0);
  for (const ArmDeviations& pattern : patterns) {
    std::vector<OffPlace> places = OffPlaces(plan, Beside(deviations, pattern), finished_from);
    for (size_t i = 0; i < places.size(); ++i) places[i].off -= known[i].off;
    if (places.empty()) return;
    const MeasuredFrame frame = FrameByArm(places);
    for (size_t i = 0; i < places.size(); ++i) {
      const OffPlace& place = places[i];
      const double left = place.normal.dot((place.off - frame.At(place.position)).head<3>()) / kSmallShare;
      squares[i] += left * left;
    }
  }
  size_t next = 0;  // in the order of OffPlaces()
  for (PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (PlannedPoint& point : pass.points) {
      if (point.point.kind != PointKind::kCut || point.skip != Infeasibility::kNone) continue;
      const double square = squares[next++];
      if (point.compensation) point.compensation->arm_left = kWithin95 * std::sqrt(square);
    }
  }
}

namespace {

/// Of the way from point `from` to `to` of a pass.
double LeftBetween(const PlanResult& plan, const PassResult& pass, size_t from, size_t to,
                   const JointLaw& law) {
  constexpr double kPerWave = 8, kMost = 512;  // places looked at
  const auto commanded = [&](size_t at) {
    const PlannedPoint& point = pass.points[at];
    return point.compensation ? point.compensation->q : point.q;
  };
  const Joints q0 = commanded(from), q1 = NearestEquivalent(q0, commanded(to));
  double waves = 0;
  for (const JointHarmonic& wave : law.harmonics)
    waves = std::max(waves, wave.harmonic * std::abs(q1[wave.joint - 1] - q0[wave.joint - 1]) / (2 * kPi));
  const int parts = static_cast<int>(std::clamp(std::ceil(kPerWave * waves), 2.0, kMost));
  const Joints off0 = law.At(q0) - q0, off1 = law.At(q1) - q1;
  const Eigen::Vector3d normal =
      BaseAt(plan, ExternalAt(pass, from)).linear().transpose() * pass.points[from].point.normal;
  double largest = 0;
  for (int part = 1; part < parts; ++part) {
    const double share = static_cast<double>(part) / parts;
    const Joints q = q0 + share * (q1 - q0);
    const Joints left = law.At(q) - q - (off0 + share * (off1 - off0));
    const Vector3d moved = Jacobian(plan.arm, q, plan.X_FT.translation()).topRows<3>() * left;
    largest = std::max(largest, std::abs(normal.dot(moved)));
  }
  return largest;
}

}  // namespace

double LeftBetweenPoints(const PlanResult& plan, const JointLaw& law, int finished_from) {
  double largest = 0;
  if (law.harmonics.empty()) return largest;
  const auto cut = [](const PlannedPoint& point) {
    return point.point.kind == PointKind::kCut && point.skip == Infeasibility::kNone;
  };
  for (const PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (const Segment& piece : pass.pieces) {
      const auto look = [&](int from, int to) {
        const auto a = static_cast<size_t>(from), b = static_cast<size_t>(to);
        if (cut(pass.points[a]) && cut(pass.points[b]))
          largest = std::max(largest, LeftBetween(plan, pass, a, b, law));
      };
      for (int i = piece.first; i < piece.last; ++i) look(i, i + 1);
      if (piece.closed) look(piece.last, piece.first);
    }
  }
  return largest;
}

}  // namespace millpose
