// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/corner.hpp"

#include "base/trig.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kNoLength = 1e-6;  // mm

/// Axis times angle, in the frame that both rotations are given in.
Vector3d RotationVector(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  Eigen::Quaterniond turn(Eigen::Matrix3d(to * from.transpose()));
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();
  return sine > 1e-12 ? Vector3d(turn.vec() * (2 * Atan2(sine, turn.w()) / sine)) : Vector3d::Zero();
}

}  // namespace

CornerRounding RoundingOf(const Pose& before, const Pose& corner, const Pose& after, const Motion& motion,
                          bool by_distance) {
  const Vector3d in = corner.translation() - before.translation();
  const Vector3d out = after.translation() - corner.translation();
  const double shorter = std::min(in.norm(), out.norm());
  if (shorter < kNoLength) return {};
  const double reach = by_distance ? std::min(motion.blend, shorter / 2) : shorter / 2;
  const Vector3d turn_in = RotationVector(before.linear(), corner.linear()) / in.norm();
  const Vector3d turn_out = RotationVector(corner.linear(), after.linear()) / out.norm();
  CornerRounding rounding{reach / 4 * (out.normalized() - in.normalized()).norm(),
                          reach / 4 * (turn_out - turn_in).norm()};
  if (by_distance) return rounding;
  rounding.position = std::min(rounding.position, motion.blend);
  rounding.angle = std::min(rounding.angle, motion.angle_blend);
  return rounding;
}

Joints OverlapRounding(const Joints& before, const Joints& after, const Joints& acceleration,
                       double shorter) {
  const double stop = before.cwiseAbs().cwiseMax(after.cwiseAbs()).cwiseQuotient(acceleration).maxCoeff();
  return std::min(stop, shorter) / 8 * (after - before);
}

}  // namespace millpose
