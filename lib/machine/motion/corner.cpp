// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/corner.hpp"

#include <limits>

#include "machine/motion/rotation_vector.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kNoLength = 1e-6;  // mm
constexpr double kNone = 1e-12;     // a bend or twist below this is rounding noise

/// The reach at which a deviation of reach/4·change comes to `most`.
double ReachFor(double change, double most) {
  return change > kNone ? 4 * most / change : std::numeric_limits<double>::infinity();
}

/// The speed at which a velocity changes by speed·change over 2·reach of travel with acceleration `most`.
double SpeedFor(double change, double reach, double most) {
  return change > kNone ? std::sqrt(2 * reach * most / change) : std::numeric_limits<double>::infinity();
}

}  // namespace

PathTolerance WrittenTolerance(const PathTolerance& verified) {
  return {kWrittenShare * verified.position, kWrittenShare * verified.angle};
}

Corner CornerBetween(const Pose& before, const Pose& corner, const Pose& after) {
  const Vector3d in = corner.translation() - before.translation();
  const Vector3d out = after.translation() - corner.translation();
  const double shorter = std::min(in.norm(), out.norm());
  if (shorter < kNoLength) return {};
  const Vector3d turn_in = RotationVector(corner.linear() * before.linear().transpose()) / in.norm();
  const Vector3d turn_out = RotationVector(after.linear() * corner.linear().transpose()) / out.norm();
  return {shorter, (out.normalized() - in.normalized()).norm(), (turn_out - turn_in).norm()};
}

CornerRounding RoundedBy(const Corner& corner, double reach) {
  const double quarter = std::min(reach, corner.shorter / 2) / 4;
  return {quarter * corner.bend, quarter * corner.twist};
}

double LargestReach(const Corner& corner, const PathTolerance& tolerance) {
  return std::min({corner.shorter / 2, ReachFor(corner.bend, tolerance.position),
                   ReachFor(corner.twist, tolerance.angle)});
}

double CornerSpeed(const Corner& corner, double reach, const PathDynamics& dynamics) {
  const double used = std::min(reach, corner.shorter / 2);
  double speed = std::min(used / dynamics.cycle, SpeedFor(corner.bend, used, dynamics.acceleration));
  if (dynamics.turn_acceleration)
    speed = std::min(speed, SpeedFor(corner.twist, used, *dynamics.turn_acceleration));
  return speed;
}

double BlockSpeed(double length, const PathDynamics& dynamics) { return length / dynamics.block_time; }

double StopTime(const Joints& before, const Joints& after, const Joints& acceleration) {
  return before.cwiseAbs().cwiseMax(after.cwiseAbs()).cwiseQuotient(acceleration).maxCoeff();
}

Joints OverlapRounding(const Joints& before, const Joints& after, const Joints& acceleration,
                       double shorter) {
  return std::min(StopTime(before, after, acceleration), shorter) / 8 * (after - before);
}

}  // namespace millpose
